#include "common/calibration/miv.h"

#include "tests/common/calibration/expect_camera.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

// Axes of the world: x forward, y left, z up.
TEST(MivCameras, OmafAxesBecomeRightDownForward) {
  const auto calibration = ParseMivCameras(samples::kMiv, "sequence.json");
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  ASSERT_EQ(calibration->cameras.size(), 4U) << "the viewport is no camera";
  ExpectPose(calibration->cameras[0].camera, Rows({0, -1, 0}, {0, 0, -1}, {1, 0, 0}), {0, 0, 0});
  ExpectPose(calibration->cameras[1].camera, Rows({1, 0, 0}, {0, 0, -1}, {0, 1, 0}), {-1, 3, -2});
  ExpectPose(calibration->cameras[2].camera, Rows({0, -1, 0}, {-1, 0, 0}, {0, 0, -1}), {0, 0, 1});
  ExpectPose(calibration->cameras[3].camera, Rows({0, 0, -1}, {0, 1, 0}, {1, 0, 0}), {0, 0, 0});
}

TEST(MivCameras, PrincipalPointsCountFromTheCentreOfAPixel) {
  const auto calibration = ParseMivCameras(samples::kMiv, "sequence.json");
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  const CalibratedCamera& first = calibration->cameras[0];
  EXPECT_EQ(first.camera.name, "v0");
  EXPECT_EQ(first.camera.width, 640);
  EXPECT_EQ(first.camera.height, 480);
  EXPECT_EQ(first.camera.intrinsics, Rows({500, 0, 319.5}, {0, 510, 239.5}, {0, 0, 1}));
  EXPECT_EQ(first.z_near, 2);
  EXPECT_EQ(first.z_far, 9.5);
  EXPECT_EQ(calibration->frame_rate, 30);
}

}  // namespace
}  // namespace depthfarm
