#include "common/calibration/ftv.h"

#include <Eigen/Geometry>

#include "tests/common/calibration/expect_camera.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

using Pose = FtvConvention::Pose;

std::vector<CalibratedCamera> Parsed(const FtvConvention& convention) {
  const auto calibration = ParseFtvCameras(samples::kFtv, "cam.txt", {640, 480}, convention);
  EXPECT_TRUE(calibration.ok()) << calibration.status().message();
  return calibration.ok() ? calibration->cameras : std::vector<CalibratedCamera>(2);
}

TEST(FtvCameras, NamesSizesAndIntrinsicsAreThoseOfTheFile) {
  const auto cameras = Parsed({});
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].camera.name, "left");
  EXPECT_EQ(cameras[1].camera.name, "right");
  EXPECT_EQ(cameras[1].camera.width, 640);
  EXPECT_EQ(cameras[1].camera.height, 480);
  EXPECT_EQ(cameras[1].camera.intrinsics, Rows({500, 0.5, 300}, {0, 510, 240}, {0, 0, 1}));
  EXPECT_EQ(cameras[1].picture, "");
  EXPECT_FALSE(cameras[1].z_near.has_value());
}

TEST(FtvCameras, TranslationsAreCentresUnlessToldOtherwise) {
  ExpectPose(Parsed({})[0].camera, Eigen::Matrix3d::Identity(), {0, 0, 0});
  ExpectPose(Parsed({})[1].camera, TurnedRight(), {-1, 0, -2});
  EXPECT_TRUE(CenterInWorld(Parsed({})[1].camera).isApprox(Eigen::Vector3d(2, 0, 1)));
}

TEST(FtvCameras, OtherPosesAreTakenAsTold) {
  const Camera inverse = Parsed({.pose = Pose::kCameraToWorld, .scene_behind = false})[1].camera;
  ExpectPose(inverse, TurnedRight().transpose(), {-2.2, 0, 0.4});
  EXPECT_TRUE(CenterInWorld(inverse).isApprox(Eigen::Vector3d(2, 0, 1)));
  ExpectPose(Parsed({.pose = Pose::kWorldToCamera, .scene_behind = false})[1].camera, TurnedRight(), {2, 0, 1});
}

// A point X at z < 0 of the file's camera and its mirror image at z > 0 of ours have the same pixel.
TEST(FtvCameras, ASceneBehindIsMirroredToTheFrontWithTheSamePixels) {
  const Camera found = Parsed({})[1].camera;
  const Camera ours = Parsed({.pose = Pose::kCentre, .scene_behind = true})[1].camera;
  ExpectPose(ours, TurnedRight(), {1, 0, 2});
  const Eigen::Vector3d point(0.3, -0.4, -7);
  const Eigen::Vector3d in_found = found.cam_from_world_rotation * point + found.cam_from_world_translation;
  const Eigen::Vector3d in_ours = ours.cam_from_world_rotation * -point + ours.cam_from_world_translation;
  ASSERT_LT(in_found[2], 0);
  EXPECT_GT(in_ours[2], 0);
  EXPECT_TRUE((found.intrinsics * in_found).hnormalized().isApprox((ours.intrinsics * in_ours).hnormalized()));
}

TEST(FtvCameras, AMarkOfUtf8AndEndsOfLinesOfWindowsChangeNothing) {
  std::string text = "\xef\xbb\xbf" + std::string(samples::kFtv);
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) text.insert(at, "\r");
  const auto calibration = ParseFtvCameras(text, "cam.txt", {640, 480}, {});
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  EXPECT_EQ(calibration->cameras, Parsed({}));
}

}  // namespace
}  // namespace depthfarm
