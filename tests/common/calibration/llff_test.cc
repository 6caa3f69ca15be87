#include "common/calibration/llff.h"

#include "tests/common/calibration/expect_camera.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

TEST(LlffCameras, AxesAreReorderedAndPosesInverted) {
  const auto calibration = ParseLlffCameras(samples::Llff(), "poses_bounds.npy", {"left.png", "right.JPG"});
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  ASSERT_EQ(calibration->cameras.size(), 2U);
  ExpectPose(calibration->cameras[0].camera, Eigen::Matrix3d::Identity(), {0, 0, 0});
  const CalibratedCamera& right = calibration->cameras[1];
  EXPECT_EQ(right.camera.name, "right");
  EXPECT_EQ(right.picture, "right.JPG");
  EXPECT_EQ(right.camera.width, 640);
  EXPECT_EQ(right.camera.height, 480);
  EXPECT_EQ(right.camera.intrinsics, Rows({500, 0, 319.5}, {0, 500, 239.5}, {0, 0, 1}));
  ExpectPose(right.camera, TurnedRight(), {-1, 0, -2});
  EXPECT_EQ(right.z_near, 2.5);
  EXPECT_EQ(right.z_far, 9.5);
}

TEST(LlffCameras, AreNumberedWithoutPictures) {
  const auto calibration = ParseLlffCameras(samples::Llff(), "poses_bounds.npy", {});
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  EXPECT_EQ(calibration->cameras[1].camera.name, "001");
  EXPECT_EQ(calibration->cameras[1].picture, "");
}

TEST(LlffCameras, ATableByColumnsIsTheSame) {
  const std::vector<double>& numbers = samples::LlffNumbers();
  std::vector<double> by_columns;
  for (std::size_t column = 0; column < 17; ++column)
    for (std::size_t row = 0; row < 2; ++row) by_columns.push_back(numbers[17 * row + column]);
  const std::string bytes = samples::Npy("{ 'shape': (2,17), 'fortran_order':True, 'descr':'<f8'}  ", by_columns);
  const auto calibration = ParseLlffCameras(bytes, "poses_bounds.npy", {});
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  EXPECT_EQ(calibration->cameras, ParseLlffCameras(samples::Llff(), "poses_bounds.npy", {})->cameras);
}

}  // namespace
}  // namespace depthfarm
