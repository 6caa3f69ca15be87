#include "common/calibration/msr.h"

#include "tests/common/calibration/expect_camera.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

TEST(MsrCameras, RowsFromTheBottomAndYUpAreTurnedRound) {
  const auto calibration = ParseMsrCameras(samples::kMsr, "calibParams.txt", {640, 480});
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  ASSERT_EQ(calibration->cameras.size(), 2U);
  const Camera& first = calibration->cameras[0].camera;
  EXPECT_EQ(first.name, "cam0");
  EXPECT_EQ(first.intrinsics(1, 2), 239.5);  // the middle stays
  ExpectPose(first, Eigen::Matrix3d::Identity(), {0, 0, 0});
  const Camera& second = calibration->cameras[1].camera;
  EXPECT_EQ(second.name, "cam1");
  EXPECT_EQ(second.intrinsics, Rows({500, -0.5, 300}, {0, 510, 479 - 240}, {0, 0, 1}));
  ExpectPose(second, Rows({1, 0, 0}, {0, 0.8, 0.6}, {0, -0.6, 0.8}), {3, -4, 5});
}

}  // namespace
}  // namespace depthfarm
