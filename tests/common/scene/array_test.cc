#include "common/scene/array.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "common/geometry/depth_levels.h"
#include "common/geometry/neighbours.h"
#include "common/scene/scene.h"

namespace depthfarm {
namespace {

constexpr ArrayKind kAllKinds[] = {ArrayKind::kArc, ArrayKind::kLine, ArrayKind::kGrid, ArrayKind::kIrregular,
                                   ArrayKind::kMixed};

double AngleBetween(const Camera& a, const Camera& b) {
  return std::acos(OpticalAxisInWorld(a).dot(OpticalAxisInWorld(b))) * 180 / std::numbers::pi;
}

TEST(CameraArray, KindsAreParsedAndOthersAreNamed) {
  EXPECT_EQ(ParseArrayKind("grid").value(), ArrayKind::kGrid);
  const Result<ArrayKind> wrong = ParseArrayKind("ring");
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(wrong.status().message().find("'ring'"), std::string::npos);
}

TEST(CameraArray, EveryKindAndCountIsValidAndNamedInOrder) {
  for (const ArrayKind kind : kAllKinds) {
    for (const int count : {1, 2, 3, 7, 16, 256}) {
      const std::vector<Camera> cameras = MakeArray(kind, count, 320, 240, 1);
      ASSERT_EQ(cameras.size(), static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i) {
        EXPECT_TRUE(ValidateCamera(cameras[i]).ok()) << ValidateCamera(cameras[i]).message();
        EXPECT_EQ(cameras[i].name, "cam" + std::to_string(i));
      }
    }
  }
}

TEST(CameraArray, NoTwoCamerasStandInOnePlace) {
  for (const ArrayKind kind : kAllKinds) {
    const std::vector<Camera> cameras = MakeArray(kind, 64, 320, 240, 3);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GT((CenterInWorld(cameras[i]) - CenterInWorld(cameras[j])).norm(), 0.01);
      }
    }
  }
}

TEST(CameraArray, ArcConvergesAndNeighboursAreThreeToFiveDegreesApart) {
  const std::vector<Camera> cameras = MakeArray(ArrayKind::kArc, 8, 1024, 768, 1);
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    EXPECT_GT(AngleBetween(cameras[i - 1], cameras[i]), 3);
    EXPECT_LT(AngleBetween(cameras[i - 1], cameras[i]), 5);
  }
  // All axes pass through one point: in each picture it is the principal point.
  const Eigen::Vector3d target(0, 0.2, 4.2);
  for (const Camera& camera : cameras) {
    const Eigen::Vector3d p = camera.cam_from_world_rotation * target + camera.cam_from_world_translation;
    EXPECT_NEAR(p.x(), 0, 1e-12);
    EXPECT_NEAR(p.y(), 0, 1e-12);
    EXPECT_NEAR(p.z(), (CenterInWorld(cameras[0]) - target).norm(), 1e-12);
  }
}

TEST(CameraArray, NeighboursOfAnArcOrLineHaveFortyToSixtyPixelsOfDisparity) {
  const Scene scene = MakeScene(1);
  for (const ArrayKind kind : {ArrayKind::kArc, ArrayKind::kLine}) {
    const std::vector<Camera> cameras = MakeArray(kind, 8, 1024, 768, 1);
    const Camera& reference = cameras[CentreCamera(cameras)];
    const DepthRange range = SceneDepthRange(scene, cameras, reference, 1).value();
    const DepthLevels levels = DepthLevels::Create(reference, range.z_near, range.z_far, 2).value();
    for (std::size_t i = 1; i < cameras.size(); ++i) {
      const double disparity = DisparityRange(cameras[i], cameras[i - 1], levels);
      EXPECT_GT(disparity, 40);
      EXPECT_LT(disparity, 62);
    }
  }
}

TEST(CameraArray, LineAndGridAreParallelAndStepAlongTheirOwnAxes) {
  for (const ArrayKind kind : {ArrayKind::kLine, ArrayKind::kGrid}) {
    const std::vector<Camera> cameras = MakeArray(kind, 9, 320, 240, 1);
    for (const Camera& camera : cameras) {
      EXPECT_EQ(camera.cam_from_world_rotation, cameras[0].cam_from_world_rotation);
      // Same depth of every point in all cameras: no step along the axis.
      EXPECT_NEAR(camera.cam_from_world_translation.z(), cameras[0].cam_from_world_translation.z(), 1e-12);
    }
  }
  const std::vector<Camera> line = MakeArray(ArrayKind::kLine, 9, 320, 240, 1);
  EXPECT_NEAR(line[0].cam_from_world_translation.y(), line[8].cam_from_world_translation.y(), 1e-12);
  const std::vector<Camera> grid = MakeArray(ArrayKind::kGrid, 9, 320, 240, 1);
  std::set<long> columns;
  std::set<long> rows;
  for (const Camera& camera : grid) {
    columns.insert(std::lround(camera.cam_from_world_translation.x() * 1000));
    rows.insert(std::lround(camera.cam_from_world_translation.y() * 1000));
  }
  EXPECT_EQ(columns.size(), 3u);
  EXPECT_EQ(rows.size(), 3u);
}

TEST(CameraArray, IrregularCamerasDifferInEverythingAndFollowTheSeed) {
  const std::vector<Camera> one = MakeArray(ArrayKind::kIrregular, 6, 320, 240, 1);
  const std::vector<Camera> again = MakeArray(ArrayKind::kIrregular, 6, 320, 240, 1);
  const std::vector<Camera> other = MakeArray(ArrayKind::kIrregular, 6, 320, 240, 2);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].cam_from_world_rotation, again[i].cam_from_world_rotation);
    EXPECT_EQ(one[i].cam_from_world_translation, again[i].cam_from_world_translation);
    EXPECT_NE(one[i].cam_from_world_translation, other[i].cam_from_world_translation);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NE(one[i].intrinsics(0, 0), one[j].intrinsics(0, 0));
      EXPECT_NE(one[i].cam_from_world_rotation, one[j].cam_from_world_rotation);
      EXPECT_NE(CenterInWorld(one[i]).z(), CenterInWorld(one[j]).z());
    }
  }
}

TEST(CameraArray, MixedPicturesDifferInSizeWithinTheGivenOne) {
  std::set<int> widths;
  for (const Camera& camera : MakeArray(ArrayKind::kMixed, 6, 320, 240, 1)) {
    widths.insert(camera.width);
    EXPECT_LE(camera.width, 320);
    EXPECT_LE(camera.height, 240);
  }
  EXPECT_EQ(widths, (std::set<int>{160, 240, 320}));
}

}  // namespace
}  // namespace depthfarm
