#include "common/geometry/neighbours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/scene/array.h"
#include "tests/common/geometry/plain_geometry.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

using NeighbourNames = std::map<std::string, std::vector<std::string>>;

constexpr double kNear = 2.5;  // of the rendered room, metres
constexpr double kFar = 7.0;

NeighbourNames ByName(const std::vector<Camera>& views, const DepthLevels& levels, int max_neighbours) {
  const std::vector<std::vector<int>> chosen = ChooseNeighbours(views, levels, max_neighbours);
  EXPECT_EQ(chosen.size(), views.size());
  NeighbourNames names;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::vector<std::string>& list = names[views[i].name];
    for (const int index : chosen[i]) list.push_back(views[static_cast<std::size_t>(index)].name);
  }
  return names;
}

DepthLevels LevelsFor(const Camera& reference, double unit = 1) {
  return DepthLevels::Create(reference, kNear * unit, kFar * unit, 2).value();
}

NeighbourNames Neighbours(const std::vector<Camera>& views, int max_neighbours) {
  return ByName(views, LevelsFor(views[static_cast<std::size_t>(CentreCamera(views))]), max_neighbours);
}

std::vector<Camera> Line(const std::vector<double>& xs) {
  std::vector<Camera> views;
  for (const double x : xs) {
    views.push_back(ForwardCamera("cam" + std::to_string(views.size()), x, 0, 320, 240, 300));
  }
  return views;
}

TEST(ChooseNeighbours, OfAnArcAreTheNearestLeftAndRight) {  // III-C
  const NeighbourNames names = Neighbours(MakeArray(ArrayKind::kArc, 7, 320, 240, 1), 2);
  for (int i = 1; i < 6; ++i) {
    EXPECT_THAT(names.at("cam" + std::to_string(i)),
                UnorderedElementsAre("cam" + std::to_string(i - 1), "cam" + std::to_string(i + 1)));
  }
}

TEST(ChooseNeighbours, OfTheEndsOfAnArcAreOne) {
  const NeighbourNames names = Neighbours(MakeArray(ArrayKind::kArc, 7, 320, 240, 1), 2);
  EXPECT_THAT(names.at("cam0"), ElementsAre("cam1"));
  EXPECT_THAT(names.at("cam6"), ElementsAre("cam5"));
}

TEST(ChooseNeighbours, FourOfAnArcAreTwoLeftAndTwoRight) {
  const NeighbourNames names = Neighbours(MakeArray(ArrayKind::kArc, 7, 320, 240, 1), 4);
  EXPECT_THAT(names.at("cam3"), UnorderedElementsAre("cam1", "cam2", "cam4", "cam5"));
  EXPECT_THAT(names.at("cam0"), ElementsAre("cam1", "cam2", "cam3", "cam4"));
  EXPECT_THAT(names.at("cam1"), UnorderedElementsAre("cam0", "cam2", "cam3", "cam4"));
}

TEST(ChooseNeighbours, OfAGridAreLeftAndRightWhereThereAreBoth) {
  const NeighbourNames names = Neighbours(MakeArray(ArrayKind::kGrid, 9, 320, 240, 1), 2);  // 0 1 2 / 3 4 5 / 6 7 8
  EXPECT_THAT(names.at("cam4"), UnorderedElementsAre("cam3", "cam5"));
  EXPECT_THAT(names.at("cam1"), UnorderedElementsAre("cam0", "cam2"));
  EXPECT_THAT(names.at("cam7"), UnorderedElementsAre("cam6", "cam8"));
}

TEST(ChooseNeighbours, OfTheCornerOfAGridAreTheOneBesideItAndTheOneAboveOrBelow) {
  const NeighbourNames names = Neighbours(MakeArray(ArrayKind::kGrid, 9, 320, 240, 1), 2);
  EXPECT_THAT(names.at("cam0"), ElementsAre("cam1", "cam3"));
  EXPECT_THAT(names.at("cam2"), ElementsAre("cam1", "cam5"));
  EXPECT_THAT(names.at("cam6"), ElementsAre("cam7", "cam3"));
  EXPECT_THAT(names.at("cam8"), ElementsAre("cam7", "cam5"));
}

TEST(ChooseNeighbours, FourOfAGridAreThoseAround) {
  const NeighbourNames names = Neighbours(MakeArray(ArrayKind::kGrid, 9, 320, 240, 1), 4);
  EXPECT_THAT(names.at("cam4"), UnorderedElementsAre("cam1", "cam3", "cam5", "cam7"));
}

TEST(ChooseNeighbours, NearestComesFirst) {
  const NeighbourNames names = Neighbours(Line({0, 0.3, 0.4}), 2);
  EXPECT_THAT(names.at("cam1"), ElementsAre("cam2", "cam0"));
}

TEST(ChooseNeighbours, AreNeverMoreThanAskedForAndNeverTheViewItself) {
  const std::vector<Camera> views = MakeArray(ArrayKind::kIrregular, 12, 320, 240, 5);
  for (const int max_neighbours : {1, 2, 3, 4, 8, 16}) {
    for (const auto& [view, list] : Neighbours(views, max_neighbours)) {
      EXPECT_LE(list.size(), static_cast<std::size_t>(max_neighbours));
      EXPECT_GE(list.size(), 1u);
      EXPECT_EQ(std::count(list.begin(), list.end(), view), 0);
      for (const std::string& name : list) EXPECT_EQ(std::count(list.begin(), list.end(), name), 1) << name;
    }
  }
}

TEST(ChooseNeighbours, TiesEndWithTheName) {
  EXPECT_THAT(Neighbours(Line({0, 0.3, 0.6}), 1).at("cam1"), ElementsAre("cam0"));
  EXPECT_THAT(Neighbours(Line({0.6, 0.3, 0}), 1).at("cam1"), ElementsAre("cam0"));
}

std::vector<std::vector<Camera>> ManyArrays() {
  std::vector<std::vector<Camera>> arrays;
  for (const ArrayKind kind : {ArrayKind::kArc, ArrayKind::kLine, ArrayKind::kGrid, ArrayKind::kIrregular}) {
    for (const int count : {2, 5, 9, 16}) arrays.push_back(MakeArray(kind, count, 320, 240, 3));
  }
  return arrays;
}

TEST(ChooseNeighbours, OrderOfTheCamerasChangesNothing) {
  std::mt19937_64 random(1);
  for (const std::vector<Camera>& views : ManyArrays()) {
    std::vector<Camera> shuffled = views;
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (const int max_neighbours : {1, 2, 4}) {
      EXPECT_EQ(Neighbours(shuffled, max_neighbours), Neighbours(views, max_neighbours));
    }
  }
}

TEST(ChooseNeighbours, WorldFrameChangesNothing) {
  std::mt19937_64 random(2);
  for (const std::vector<Camera>& views : ManyArrays()) {
    const Eigen::Matrix3d rotation = AnyRotation(random, std::numbers::pi);
    const Eigen::Vector3d shift = 20 * AnyDirection(random);
    std::vector<Camera> moved = views;  // X = rotation * X_moved + shift
    for (Camera& camera : moved) {
      camera.cam_from_world_translation += camera.cam_from_world_rotation * shift;
      camera.cam_from_world_rotation = camera.cam_from_world_rotation * rotation;
    }
    for (const int max_neighbours : {1, 2, 4}) {
      EXPECT_EQ(Neighbours(moved, max_neighbours), Neighbours(views, max_neighbours));
    }
  }
}

TEST(ChooseNeighbours, UnitOfLengthChangesNothing) {
  for (const std::vector<Camera>& views : ManyArrays()) {
    for (const double unit : {1000.0, 39.37, 1e-3}) {
      std::vector<Camera> scaled = views;
      for (Camera& camera : scaled) camera.cam_from_world_translation *= unit;
      const DepthLevels levels = LevelsFor(scaled[static_cast<std::size_t>(CentreCamera(scaled))], unit);
      for (const int max_neighbours : {1, 2, 4}) {
        EXPECT_EQ(ByName(scaled, levels, max_neighbours), Neighbours(views, max_neighbours));
      }
    }
  }
}

Camera TurnedAboutY(Camera camera, double degrees) {
  const Eigen::Vector3d center = CenterInWorld(camera);
  camera.cam_from_world_rotation =
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitY()).toRotationMatrix();
  camera.cam_from_world_translation = -(camera.cam_from_world_rotation * center);
  return camera;
}

TEST(ChooseNeighbours, DoNotLookAnotherWay) {
  std::vector<Camera> views = Line({0, 0.1, 0.4});
  views[1] = TurnedAboutY(views[1], 180);
  const NeighbourNames names = ByName(views, LevelsFor(views[0]), 2);
  EXPECT_THAT(names.at("cam0"), ElementsAre("cam2"));
  EXPECT_THAT(names.at("cam1"), IsEmpty());
}

TEST(ChooseNeighbours, LookLessThanSixtyDegreesApart) {
  // Wide pictures, so that the overlap stays large and the angle decides.
  std::vector<Camera> views;
  for (const double x : {0.0, 0.1, 0.3}) {
    views.push_back(ForwardCamera("cam" + std::to_string(views.size()), x, 0, 320, 240, 80));
  }
  views[1] = TurnedAboutY(views[1], 59);
  EXPECT_THAT(ByName(views, LevelsFor(views[0]), 1).at("cam0"), ElementsAre("cam1"));
  views[1] = TurnedAboutY(views[1], 61);
  EXPECT_THAT(ByName(views, LevelsFor(views[0]), 1).at("cam0"), ElementsAre("cam2"));
}

TEST(ChooseNeighbours, SeeAtLeastAQuarterOfTheView) {
  // On the middle plane, the harmonic mean of the range, a view is this wide: shifts of 7/8 and 5/8 of it leave 1/8 and
  // 3/8 in sight.
  const double width = 320.0 / 300 * 2 / (1 / kNear + 1 / kFar);
  EXPECT_THAT(Neighbours(Line({0, width * 7 / 8}), 2).at("cam0"), IsEmpty());
  EXPECT_THAT(Neighbours(Line({0, width * 5 / 8}), 2).at("cam0"), ElementsAre("cam1"));
}

TEST(ChooseNeighbours, DoNotStandInTheSamePlace) {
  EXPECT_THAT(Neighbours(Line({0, 0, 0.2}), 2).at("cam0"), ElementsAre("cam2"));
}

TEST(CentreCamera, IsTheMiddleOne) {
  EXPECT_EQ(CentreCamera(MakeArray(ArrayKind::kArc, 7, 320, 240, 1)), 3);
  EXPECT_EQ(CentreCamera(MakeArray(ArrayKind::kGrid, 9, 320, 240, 1)), 4);
  EXPECT_EQ(CentreCamera(Line({0, 1, 1.1, 5, 9})), 2);
  EXPECT_EQ(CentreCamera(Line({3})), 0);
}

TEST(CentreCamera, OrderFrameAndUnitChangeNothingAndTiesGoByName) {
  std::mt19937_64 random(3);
  for (const std::vector<Camera>& views : ManyArrays()) {
    const std::string expected = views[static_cast<std::size_t>(CentreCamera(views))].name;
    std::vector<Camera> other = views;
    std::shuffle(other.begin(), other.end(), random);
    const Eigen::Matrix3d rotation = AnyRotation(random, std::numbers::pi);
    for (Camera& camera : other) {
      camera.cam_from_world_translation += camera.cam_from_world_rotation * Eigen::Vector3d(4, -7, 2);
      camera.cam_from_world_translation *= 1000;
      camera.cam_from_world_rotation = camera.cam_from_world_rotation * rotation;
    }
    EXPECT_EQ(other[static_cast<std::size_t>(CentreCamera(other))].name, expected);
  }
  std::vector<Camera> square = MakeArray(ArrayKind::kGrid, 4, 320, 240, 1);  // four ties
  std::reverse(square.begin(), square.end());
  EXPECT_EQ(square[static_cast<std::size_t>(CentreCamera(square))].name, "cam0");
}

}  // namespace
}  // namespace depthfarm
