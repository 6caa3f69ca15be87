#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "common/geometry/neighbours.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

Camera CameraAt(double x, double y) { return ForwardCamera("cam", x, y, 320, 240, 300); }

DepthLevels Levels(double z_near, double z_far) {
  return DepthLevels::Create(CameraAt(0, 0), z_near, z_far, 2).value();
}

TEST(DisparityRange, OfAParallelPairIsFocalTimesBaselineTimesInverseDepths) {
  const double inverse_range = 1 / 2.0 - 1 / 10.0;
  EXPECT_NEAR(DisparityRange(CameraAt(0, 0), CameraAt(0.3, 0), Levels(2, 10)), 300 * 0.3 * inverse_range, 1e-10);
  EXPECT_NEAR(DisparityRange(CameraAt(0, 0), CameraAt(-0.3, 0), Levels(2, 10)), 300 * 0.3 * inverse_range, 1e-10);
  EXPECT_NEAR(DisparityRange(CameraAt(0, 0), CameraAt(0.3, 0.4), Levels(2, 10)), 300 * 0.5 * inverse_range, 1e-10);
}

TEST(DisparityRange, CountsPixelsOfTheNeighbour) {
  const Camera fine = ForwardCamera("fine", 0.3, 0, 640, 480, 600);
  EXPECT_NEAR(DisparityRange(CameraAt(0, 0), fine, Levels(2, 10)), 600 * 0.3 * 0.4, 1e-10);
  EXPECT_NEAR(DisparityRange(fine, CameraAt(0, 0), Levels(2, 10)), 300 * 0.3 * 0.4, 1e-10);
}

TEST(DisparityRange, IsZeroWithoutABaseline) {
  EXPECT_NEAR(DisparityRange(CameraAt(0, 0), CameraAt(0, 0), Levels(2, 10)), 0, 1e-10);
}

TEST(DisparityRange, IsZeroWhereThePointLeavesSight) {
  Camera away = CameraAt(0.3, 0);
  away.cam_from_world_rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_EQ(DisparityRange(CameraAt(0, 0), away, Levels(2, 10)), 0);
  EXPECT_EQ(DisparityRange(away, CameraAt(0, 0), Levels(2, 10)), 0);
  Camera between = CameraAt(0.3, 0);
  between.cam_from_world_translation[2] = -5;
  EXPECT_EQ(DisparityRange(CameraAt(0, 0), between, Levels(2, 10)), 0);
  EXPECT_EQ(DisparityRange(between, CameraAt(0, 0), Levels(2, 10)), 0);
}

}  // namespace
}  // namespace depthfarm
