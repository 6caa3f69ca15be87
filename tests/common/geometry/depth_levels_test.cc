#include "common/geometry/depth_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/common/geometry/plain_geometry.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Camera CameraAt(double x, double y, double z) {
  Camera camera = ForwardCamera("view", x, y, 32, 24, 40);
  camera.cam_from_world_translation[2] = -z;
  return camera;
}

DepthLevels LevelsOf(const Camera& reference, double z_near, double z_far, int count) {
  return DepthLevels::Create(reference, z_near, z_far, count).value();
}

// Turned about its own y axis where it stands.
Camera Turned(Camera camera, double angle_rad) {
  const Eigen::Vector3d center = CenterInWorld(camera);
  camera.cam_from_world_rotation =
      Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() * camera.cam_from_world_rotation;
  camera.cam_from_world_translation = -(camera.cam_from_world_rotation * center);
  return camera;
}

TEST(DepthLevels, RangeAndCountMustMakeSense) {
  struct Bad {
    double z_near;
    double z_far;
    int count;
    std::string message_part;
  };
  const Bad cases[] = {
      {0, 10, 5, "zNear 0, zFar 10"}, {-1, 10, 5, "zNear -1"},      {10, 10, 5, "zNear 10, zFar 10"},
      {10, 2, 5, "0 < zNear < zFar"}, {kNaN, 10, 5, "zNear nan"},   {1, kNaN, 5, "zFar nan"},
      {1, kInfinity, 5, "zFar inf"},  {1, 10, 1, "levels is 1"},    {1, 10, 0, "levels is 0"},
      {1, 10, -3, "levels is -3"},    {1, 10, 65535, "2 to 65534"},
  };
  for (const Bad& bad : cases) {
    const Result<DepthLevels> levels = DepthLevels::Create(CameraAt(0, 0, 0), bad.z_near, bad.z_far, bad.count);
    ASSERT_FALSE(levels.ok()) << bad.message_part;
    EXPECT_EQ(levels.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(levels.status().message(), HasSubstr(bad.message_part));
  }
  EXPECT_TRUE(DepthLevels::Create(CameraAt(0, 0, 0), 1, 10, 2).ok());
  EXPECT_TRUE(DepthLevels::Create(CameraAt(0, 0, 0), 1, 10, kMaxLevels).ok());
}

TEST(DepthLevels, EndPlanesAreTheEndsOfTheRange) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    const double z_near = Uniform(random, 0.01, 100);
    const double z_far = z_near * Uniform(random, 1.05, 1000);
    for (const int count : {2, 3, 250, kMaxLevels}) {
      const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), z_near, z_far, count);
      EXPECT_EQ(levels.count(), count);
      EXPECT_DOUBLE_EQ(levels.DepthInRef(0), z_far);
      EXPECT_DOUBLE_EQ(levels.DepthInRef(count - 1), z_near);
    }
  }
}

TEST(DepthLevels, AreUniformInInverseDepthAndALargerLevelIsNearer) {
  const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), 2, 50, 97);
  const double step = (1.0 / 2 - 1.0 / 50) / 96;
  for (int level = 1; level < 97; ++level) {
    EXPECT_NEAR(1 / levels.DepthInRef(level) - 1 / levels.DepthInRef(level - 1), step, 1e-14) << level;
  }
  // 1/2 and 1/4 are exact: half-way between them is 3/8.
  EXPECT_DOUBLE_EQ(LevelsOf(CameraAt(0, 0, 0), 2, 4, 3).DepthInRef(1), 8.0 / 3);
}

TEST(DepthLevels, DepthOfAWorldPointIsItsZInTheReferenceCamera) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100; ++i) {
    const Camera reference = AnyCamera(random, "ref", std::numbers::pi, 5);
    const DepthLevels levels = LevelsOf(reference, 1, 10, 5);
    const Eigen::Vector3d point = 20 * AnyDirection(random);
    EXPECT_NEAR(levels.DepthInRefOf(point), PointInCamera(reference, point).z(), 1e-12);
    EXPECT_LT((levels.axis_in_world() - OpticalAxisInWorld(reference)).norm(), 1e-15);
  }
}

// The definition, in the world: a plane across the reference's axis, a ray from the view's centre, their intersection,
// its depth in the view.
double OwnDepthOnPlane(const Camera& view, const Camera& reference, double depth_in_ref, double x, double y) {
  const Eigen::Vector3d normal = reference.cam_from_world_rotation.transpose() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d on_plane = PointAt(reference, 3, 5, depth_in_ref);
  const Eigen::Vector3d center = CenterInWorld(view);
  const Eigen::Vector3d ray = PointAt(view, x, y, 1) - center;
  const Eigen::Vector3d hit = center + normal.dot(on_plane - center) / normal.dot(ray) * ray;
  return PointInCamera(view, hit).z();
}

TEST(LevelsInView, RaysMeetThePlanesWhereTheyDoInTheWorld) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    const Camera reference = AnyCamera(random, "ref", std::numbers::pi, 5);
    Camera view = AnyCamera(random, "view", 0.4, 1);  // in the reference's frame, then carried into the world
    view.cam_from_world_translation += view.cam_from_world_rotation * reference.cam_from_world_translation;
    view.cam_from_world_rotation = view.cam_from_world_rotation * reference.cam_from_world_rotation;
    const DepthLevels levels = LevelsOf(reference, 2, 30, 9);
    const LevelsInView in_view(view, levels);
    EXPECT_NEAR(in_view.center_depth(), PointInCamera(reference, CenterInWorld(view)).z(), 1e-12);
    for (int level = 0; level < levels.count(); ++level) {
      const double x = Uniform(random, -0.5, 23.5);
      const double y = Uniform(random, -0.5, 15.5);
      const double depth = levels.DepthInRef(level);
      const double z = 1 / in_view.InverseDepth(x, y, depth);
      EXPECT_GT(z, 0);
      EXPECT_NEAR(z, OwnDepthOnPlane(view, reference, depth, x, y), 1e-10 * z);
      EXPECT_NEAR(in_view.DepthInRef(x, y, z), depth, 1e-10 * depth);
      EXPECT_NEAR(1 / in_view.InverseDepthOnPlane(x, y, 1 / depth), z, 1e-10 * z);
    }
  }
}

TEST(LevelsInView, DepthIsTheSameInTheReferenceItself) {
  const Camera reference = CameraAt(1, 2, 3);
  const DepthLevels levels = LevelsOf(reference, 2, 30, 9);
  const LevelsInView in_view(reference, levels);
  EXPECT_DOUBLE_EQ(in_view.center_depth(), 0);
  for (int level = 0; level < 9; ++level) {
    EXPECT_DOUBLE_EQ(in_view.InverseDepth(7, 20, levels.DepthInRef(level)), 1 / levels.DepthInRef(level));
    EXPECT_DOUBLE_EQ(in_view.InverseDepthOnPlane(7, 20, 1 / levels.DepthInRef(level)), 1 / levels.DepthInRef(level));
  }
}

TEST(LevelsInView, PlanesBehindTheViewHaveNoPositiveInverseDepth) {
  const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), 2, 30, 9);
  const LevelsInView between(CameraAt(0, 0, 5), levels);
  EXPECT_LT(between.InverseDepth(15, 11, 2), 0);
  EXPECT_GT(between.InverseDepth(15, 11, 30), 0);
  EXPECT_FALSE(between.PlaneInFront(1 / 2.0));
  EXPECT_TRUE(between.PlaneInFront(1 / 30.0));
  EXPECT_TRUE(between.PlaneInFront(0));
  EXPECT_TRUE(between.PlaneInFront(-1));
  EXPECT_FALSE(std::isfinite(between.InverseDepth(15, 11, 5)));  // the view's own plane
  const LevelsInView away(Turned(CameraAt(0, 0, 0), std::numbers::pi), levels);
  EXPECT_LT(away.InverseDepth(15, 11, 2), 0);
}

TEST(OwnDepthRange, OfAParallelViewIsTheRangeLessItsStepForward) {
  const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), 2, 30, 9);
  for (const double step : {-1.0, 0.0, 0.5, 1.5}) {
    const DepthRange range = OwnDepthRange(CameraAt(0.3, -0.2, step), levels).value();
    EXPECT_NEAR(range.z_near, 2 - step, 1e-12);
    EXPECT_NEAR(range.z_far, 30 - step, 1e-12);
  }
}

TEST(OwnDepthRange, HoldsTheDepthsOfAllPixelsOnAllPlanesAndNoMore) {
  std::mt19937_64 random(4);
  int between_planes = 0;
  for (int i = 0; i < 200; ++i) {
    const Camera reference = AnyCamera(random, "ref", 0.2, 0.1);
    const Camera view = AnyCamera(random, "view", 0.3, 3);
    const DepthLevels levels = LevelsOf(reference, 2, 30, 9);
    const LevelsInView in_view(view, levels);
    DepthRange expected{kInfinity, 0};
    for (int level = 0; level < levels.count(); ++level) {
      for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
          const double z = 1 / in_view.InverseDepth(x, y, levels.DepthInRef(level));
          if (!(z > 0)) continue;
          expected.z_near = std::min(expected.z_near, z);
          expected.z_far = std::max(expected.z_far, z);
        }
      }
    }
    if (in_view.center_depth() > levels.z_near()) ++between_planes;
    const Result<DepthRange> range = OwnDepthRange(view, levels);
    ASSERT_TRUE(range.ok()) << range.status().message();
    EXPECT_DOUBLE_EQ(range->z_near, std::max(expected.z_near, 0.1));  // 1/20 of 2
    EXPECT_DOUBLE_EQ(range->z_far, expected.z_far);
  }
  EXPECT_GT(between_planes, 10);  // or the case would go untested
}

TEST(OwnDepthRange, OfAViewBetweenThePlanesStartsAtTheFirstInFrontOfIt) {
  const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), 1, 4, 4);  // planes at 4, 2, 4/3, 1
  const DepthRange range = OwnDepthRange(CameraAt(0, 0, 1.5), levels).value();
  EXPECT_NEAR(range.z_near, 0.5, 1e-12);
  EXPECT_NEAR(range.z_far, 2.5, 1e-12);
}

TEST(OwnDepthRange, IsCutOffAtATwentiethOfTheNearestDepth) {
  const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), 1, 4, 4);
  EXPECT_DOUBLE_EQ(OwnDepthRange(CameraAt(0, 0, 1.999), levels)->z_near, 0.05);
}

TEST(OwnDepthRange, OfAViewThatSeesNoPlaneIsAnErrorThatNamesIt) {
  const DepthLevels levels = LevelsOf(CameraAt(0, 0, 0), 2, 30, 9);
  for (const Camera& blind : {Turned(CameraAt(0, 0, 0), std::numbers::pi), Turned(CameraAt(1, 0, 0), 2.5),
                              CameraAt(0, 0, 30), CameraAt(0, 0, 31),
                              // beyond the farthest plane and looking back: it sees the planes from behind
                              Turned(CameraAt(0, 0, 32), 2.8), Turned(CameraAt(0, 0, 32), std::numbers::pi)}) {
    const Result<DepthRange> range = OwnDepthRange(blind, levels);
    ASSERT_FALSE(range.ok());
    EXPECT_EQ(range.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(range.status().message(), HasSubstr("camera 'view' does not see the depth planes"));
  }
}

}  // namespace
}  // namespace depthfarm
