// Calibrations of published sets against the cameras that were made of them by hand and checked with their pictures.
// They may not be redistributed, so they are found, not shipped: DEPTHFARM_DATA names their folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "common/calibration/ftv.h"
#include "common/calibration/llff.h"
#include "common/calibration/middlebury.h"
#include "common/calibration/msr.h"
#include "common/calibration/picture_size.h"
#include "common/files/atomic_file.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

std::filesystem::path DataFolder() {
  const char* folder = std::getenv("DEPTHFARM_DATA");
  return folder != nullptr ? folder : DEPTHFARM_DATA_DEFAULT;
}

class RealCalibrations : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(DataFolder())) {
      GTEST_SKIP() << "no real sets at " << DataFolder() << ": set DEPTHFARM_DATA to the folder that holds them";
    }
  }

  static std::string Bytes(const std::string& file) {
    const auto bytes = ReadFileBytes((DataFolder() / file).string(), 1 << 20);
    EXPECT_TRUE(bytes.ok()) << bytes.status().message();
    return bytes.ok() ? *bytes : "";
  }

  // Every camera of the set's cameras.json has its like, the world included.
  static void ExpectAsByHand(const std::string& set, const Result<Calibration>& imported,
                             const std::string& sequence_file = "cameras.json") {
    SCOPED_TRACE(set);
    ASSERT_TRUE(imported.ok()) << imported.status().message();
    const auto sequence = ReadSequence((DataFolder() / set / sequence_file).string());
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    std::map<std::string, const CalibratedCamera*> by_name;
    for (const CalibratedCamera& camera : imported->cameras) by_name[camera.camera.name] = &camera;
    double difference = 0;
    for (const SequenceCamera& by_hand : sequence->cameras) {
      ASSERT_TRUE(by_name.contains(by_hand.camera.name)) << by_hand.camera.name;
      const CalibratedCamera& ours = *by_name.at(by_hand.camera.name);
      EXPECT_EQ(ours.camera.width, by_hand.camera.width);
      EXPECT_EQ(ours.camera.height, by_hand.camera.height);
      const auto compare = [&](const auto& a, const auto& b) {
        difference = std::max(difference, (a - b).cwiseAbs().maxCoeff());
      };
      compare(ours.camera.intrinsics, by_hand.camera.intrinsics);
      compare(ours.camera.cam_from_world_rotation, by_hand.camera.cam_from_world_rotation);
      compare(ours.camera.cam_from_world_translation, by_hand.camera.cam_from_world_translation);
      EXPECT_EQ(ours.z_near, by_hand.z_near);
      EXPECT_EQ(ours.z_far, by_hand.z_far);
    }
    EXPECT_LT(difference, 1e-9);  // pixels, units of length: what decimals lose
    RecordProperty(set, std::to_string(difference));
  }
};

TEST_F(RealCalibrations, FtvBalloons) {
  ExpectAsByHand("mpeg_balloons", ParseFtvCameras(Bytes("mpeg_balloons/calibration.cam_param_balloons.cfg"), "balloons",
                                                  {1024, 768}, {}));
}

TEST_F(RealCalibrations, FtvPoznanStreetLiesAtNegativeDepth) {
  ExpectAsByHand("mpeg_poznan_street",
                 ParseFtvCameras(Bytes("mpeg_poznan_street/calibration.cam_param_poznanstreet.txt"), "poznan",
                                 {1920, 1088}, {.pose = FtvConvention::Pose::kCentre, .scene_behind = true}));
}

TEST_F(RealCalibrations, MsrBallet) {
  ExpectAsByHand("msr_ballet",
                 ParseMsrCameras(Bytes("msr_ballet/calibration.calibParams-ballet.txt"), "ballet", {1024, 768}));
}

TEST_F(RealCalibrations, MiddleburyTempleRing) {
  ExpectAsByHand(
      "middlebury_temple_ring",
      ParseMiddleburyCameras(Bytes("middlebury_temple_ring/calibration.templeR_par.txt"), "temple", {640, 480}));
}

TEST_F(RealCalibrations, LlffFernAtBothSizes) {
  std::vector<std::string> pictures;
  for (const auto& entry : std::filesystem::directory_iterator(DataFolder() / "llff_fern" / "images_4"))
    pictures.push_back(entry.path().filename().string());
  std::sort(pictures.begin(), pictures.end());
  const auto calibration = ParseLlffCameras(Bytes("llff_fern/calibration.poses_bounds.npy"), "fern", pictures);
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  for (const auto& [file, size] :
       {std::pair{"cameras.json", PictureSize{1008, 756}}, std::pair{"cameras_504x378.json", PictureSize{504, 378}}}) {
    Calibration scaled = *calibration;
    for (CalibratedCamera& camera : scaled.cameras) camera.camera = CameraOfSize(camera.camera, size).value();
    ExpectAsByHand("llff_fern", scaled, file);
  }
}

}  // namespace
}  // namespace depthfarm
