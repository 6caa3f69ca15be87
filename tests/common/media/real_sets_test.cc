// The published sets the project is measured on. They may not be redistributed, so they are found, not shipped:
// DEPTHFARM_DATA names their folder.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/media/ground_truth.h"
#include "common/media/picture_reader.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

std::filesystem::path DataFolder() {
  const char* folder = std::getenv("DEPTHFARM_DATA");
  return folder != nullptr ? folder : DEPTHFARM_DATA_DEFAULT;
}

class RealSets : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(DataFolder())) {
      GTEST_SKIP() << "no real sets at " << DataFolder() << ": set DEPTHFARM_DATA to the folder that holds them";
    }
  }

  // All cameras*.json of all sets, sorted.
  static std::vector<std::string> Files() {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(DataFolder())) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("cameras") && name.ends_with(".json")) files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  static Sequence Read(const std::string& set) {
    auto sequence = ReadSequence((DataFolder() / set / "cameras.json").string());
    EXPECT_TRUE(sequence.ok()) << sequence.status().message();
    return sequence.ok() ? *sequence : Sequence();
  }
};

TEST_F(RealSets, AllLoadWithoutAWarning) {
  EXPECT_THAT(Files(), ::testing::Not(IsEmpty()));
  for (const std::string& file : Files()) {
    const auto sequence = ReadSequence(file);
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    EXPECT_THAT(sequence->warnings, IsEmpty()) << file;
  }
}

TEST_F(RealSets, FirstPictureOfEveryCameraDecodes) {
  for (const std::string& file : Files()) {
    const auto sequence = ReadSequence(file);
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    for (const SequenceCamera& camera : sequence->cameras) {
      if (camera.images.empty()) continue;
      const auto picture = ReadPicture({camera.images[0], camera.format, camera.camera.width, camera.camera.height}, 4);
      ASSERT_TRUE(picture.ok()) << picture.status().message();
      const auto [least, most] = std::minmax_element(picture->values().begin(), picture->values().end(),
                                                     [](const Ycbcr& a, const Ycbcr& b) { return a.y < b.y; });
      EXPECT_GT(most->y - least->y, 50) << camera.images[0] << " has no contrast";
    }
  }
}

TEST_F(RealSets, MeasuredDepthLiesInTheRangeOfTheSequence) {
  for (const auto& [set, least_known] :
       std::map<std::string, double>{{"hci_antinous", 0.99}, {"middlebury_cones", 0.8}, {"middlebury_venus", 0.8}}) {
    const Sequence sequence = Read(set);
    ASSERT_THAT(sequence.ground_truth, SizeIs(1)) << set;
    const GroundTruthView& view = sequence.ground_truth[0];
    const auto camera = std::find_if(sequence.cameras.begin(), sequence.cameras.end(),
                                     [&](const SequenceCamera& c) { return c.camera.name == view.view; });
    ASSERT_NE(camera, sequence.cameras.end());
    const auto truth = ReadGroundTruth(view, 0, camera->camera.width, camera->camera.height);
    ASSERT_TRUE(truth.ok()) << truth.status().message();
    std::size_t known = 0;
    for (const float z : truth->depth.values()) {
      if (z == 0) continue;
      ++known;
      // A quarter beyond: ranges of the sets were rounded by hand.
      ASSERT_GT(z, 0.8 * *sequence.z_near) << set;
      ASSERT_LT(z, 1.25 * *sequence.z_far) << set;
    }
    EXPECT_GT(static_cast<double>(known), least_known * static_cast<double>(truth->depth.size())) << set;
    EXPECT_EQ(truth->nonoccluded.empty(), set == "hci_antinous");
  }
}

TEST_F(RealSets, BalletHasEightCamerasTwoOfThemWithPictures) {
  const Sequence ballet = Read("msr_ballet");
  EXPECT_EQ(ballet.name, "msr_ballet");
  ASSERT_THAT(ballet.cameras, SizeIs(8));
  EXPECT_EQ(std::count_if(ballet.cameras.begin(), ballet.cameras.end(),
                          [](const SequenceCamera& camera) { return !camera.images.empty(); }),
            2);
}

}  // namespace
}  // namespace depthfarm
