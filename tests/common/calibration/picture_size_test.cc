#include "common/calibration/picture_size.h"

#include "tests/common/calibration/expect_camera.h"

namespace depthfarm {
namespace {

Camera Calibrated() {
  Camera camera{.name = "a", .width = 640, .height = 480};
  camera.intrinsics = Rows({500, 2, 319.5}, {0, 510, 200}, {0, 0, 1});
  return camera;
}

TEST(CameraOfSize, HalfIsThatOfDownscaled) {
  const auto half = CameraOfSize(Calibrated(), {320, 240});
  ASSERT_TRUE(half.ok()) << half.status().message();
  EXPECT_EQ(*half, Downscaled(Calibrated(), 2));
}

TEST(CameraOfSize, TheMiddleStaysTheMiddle) {
  const auto larger = CameraOfSize(Calibrated(), {1920, 1440});
  ASSERT_TRUE(larger.ok()) << larger.status().message();
  EXPECT_EQ(larger->intrinsics(0, 2), 959.5);
  EXPECT_EQ(larger->intrinsics(0, 0), 1500);
}

TEST(CameraOfSize, ASizeThatWasRoundedIsTaken) { EXPECT_TRUE(CameraOfSize(Calibrated(), {213, 160}).ok()); }

TEST(CameraOfSize, AnotherShapeIsRefused) {
  const auto wide = CameraOfSize(Calibrated(), {640, 360});
  EXPECT_EQ(wide.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(wide.status().message().find("camera 'a' was calibrated for pictures of 640x480"), std::string::npos);
}

}  // namespace
}  // namespace depthfarm
