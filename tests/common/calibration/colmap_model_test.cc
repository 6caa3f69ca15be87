#include "common/calibration/colmap_model.h"

#include <gmock/gmock.h>

#include "tests/common/calibration/expect_camera.h"
#include "tests/support/calibration_samples.h"

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

Result<ColmapModel> TextModel(std::string_view cameras, std::string_view images, std::string_view points) {
  return ParseColmapModel({.binary = false,
                           .cameras = {"cameras.txt", cameras},
                           .images = {"images.txt", images},
                           .points = ColmapFile{"points3D.txt", points}});
}

Result<ColmapModel> SampleText() {
  return TextModel(samples::kColmapCameras, samples::kColmapImages, samples::ColmapPoints());
}

TEST(ColmapModel, ImagesAreCamerasInTheOrderOfTheirNames) {
  const auto model = SampleText();
  ASSERT_TRUE(model.ok()) << model.status().message();
  const std::vector<CalibratedCamera>& cameras = model->calibration.cameras;
  ASSERT_THAT(cameras, SizeIs(2));
  EXPECT_EQ(cameras[0].camera.name, "rig_left");
  EXPECT_EQ(cameras[0].picture, "rig/left.jpg");
  EXPECT_EQ(cameras[0].camera.intrinsics, Rows({500, 0, 319.5}, {0, 500, 239.5}, {0, 0, 1})) << "half a pixel less";
  ExpectPose(cameras[0].camera, Eigen::Matrix3d::Identity(), {0, 0, 0});
  EXPECT_EQ(cameras[1].camera.name, "rig_right");
  EXPECT_EQ(cameras[1].camera.intrinsics, Rows({500, 0, 300}, {0, 510, 240}, {0, 0, 1}));
  ExpectPose(cameras[1].camera, TurnedRight(), {-1, 0, -2});
}

TEST(ColmapModel, BinaryIsTheSameAsText) {
  const std::string cameras = samples::ColmapCamerasBinary();
  const std::string images = samples::ColmapImagesBinary();
  const std::string points = samples::ColmapPointsBinary();
  const auto binary = ParseColmapModel({.binary = true,
                                        .cameras = {"cameras.bin", cameras},
                                        .images = {"images.bin", images},
                                        .points = ColmapFile{"points3D.bin", points}});
  ASSERT_TRUE(binary.ok()) << binary.status().message();
  const auto text = SampleText();
  ASSERT_TRUE(text.ok()) << text.status().message();
  EXPECT_EQ(binary->calibration.cameras, text->calibration.cameras);
  EXPECT_EQ(binary->depths, text->depths);
}

TEST(ColmapModel, DepthsOfPointsAreAlongTheAxisOfEachCamera) {
  const auto model = SampleText();
  ASSERT_TRUE(model.ok()) << model.status().message();
  ASSERT_THAT(model->depths, ElementsAre(SizeIs(samples::kColmapPointCount), SizeIs(samples::kColmapPointCount)));
  EXPECT_EQ(model->depths[0][3], 7);
  EXPECT_FLOAT_EQ(model->depths[1][3], 7 * 0.8F - 2);
}

TEST(ColmapModel, APointOfAnImageThatIsNotThereCountsForTheOthers) {
  const auto model = TextModel(samples::kColmapCameras, samples::kColmapImages, "1 0 0 5 0 0 0 1 99 0 2 0\n");
  ASSERT_TRUE(model.ok()) << model.status().message();
  EXPECT_THAT(model->depths, ElementsAre(ElementsAre(5), SizeIs(0)));
}

TEST(ColmapModel, NamesThatDifferInTheirEndingsKeepThem) {
  const auto model = TextModel("1 PINHOLE 64 48 50 50 32 24\n",
                               "1 1 0 0 0 0 0 0 1 a/0.jpg\n\n2 1 0 0 0 1 0 0 1 a/0.png\n\n3 1 0 0 0 2 0 0 1 my cam.jpg",
                               "1 0 0 5 0 0 0 1\n");
  ASSERT_TRUE(model.ok()) << model.status().message();
  const auto& cameras = model->calibration.cameras;
  ASSERT_THAT(cameras, SizeIs(3));
  EXPECT_EQ(cameras[0].camera.name, "a_0.jpg");
  EXPECT_EQ(cameras[1].camera.name, "a_0.png");
  EXPECT_EQ(cameras[2].camera.name, "my cam");
}

TEST(ColmapModel, QuaternionsOfFewDigitsAreBroughtToLengthOne) {
  const auto model =
      TextModel("1 PINHOLE 64 48 50 50 32 24\n", "1 0.95 0 -0.317 0 0 0 0 1 a.jpg\n", "1 0 0 5 0 0 0 1\n");
  ASSERT_TRUE(model.ok()) << model.status().message();
  const Eigen::Matrix3d r = model->calibration.cameras[0].camera.cam_from_world_rotation;
  EXPECT_TRUE((r * r.transpose()).isIdentity(1e-14));
}

}  // namespace
}  // namespace depthfarm
