#include "common/calibration/middlebury.h"

#include "tests/common/calibration/expect_camera.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

TEST(MiddleburyCameras, AreTakenAsTheyAreAndNamePictures) {
  const auto calibration = ParseMiddleburyCameras(samples::kMiddlebury, "a_par.txt", {640, 480});
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  ASSERT_EQ(calibration->cameras.size(), 2U);
  const CalibratedCamera& right = calibration->cameras[1];
  EXPECT_EQ(right.camera.name, "right");
  EXPECT_EQ(right.picture, "right.png");
  EXPECT_EQ(right.camera.intrinsics, Rows({500, 0.5, 300}, {0, 510, 240}, {0, 0, 1}));
  ExpectPose(right.camera, TurnedRight(), {-1, 0, -2});
}

}  // namespace
}  // namespace depthfarm
