#include "common/sequence/guides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/files/atomic_file.h"
#include "common/sequence/depth_manifest.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::TemporaryFolder;

Camera SmallCamera(const std::string& name) {
  Camera camera;
  camera.name = name;
  camera.width = 8;
  camera.height = 6;
  camera.intrinsics << 8, 0, 3.5, 0, 8, 2.5, 0, 0, 1;
  return camera;
}

// Two cameras with three frames each.
Sequence ThreeFrames() {
  Sequence sequence;
  sequence.file = "/seq.json";
  for (const char* name : {"a", "b"}) {
    SequenceCamera camera;
    camera.camera = SmallCamera(name);
    camera.images = {"/0.png", "/1.png", "/2.png"};
    camera.masks = {"/m0.png", "/m1.png", "/m2.png"};
    sequence.cameras.push_back(camera);
  }
  return sequence;
}

class Guides : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text = "x") {
    const std::filesystem::path file = std::filesystem::path(folder_.path()) / name;
    std::filesystem::create_directories(file.parent_path());
    return folder_.Write(name, text);
  }
  std::string folder() const { return std::filesystem::path(folder_.path()).string(); }

  TemporaryFolder folder_;
};

TEST_F(Guides, PriorsAreFoundByCameraAndFrame) {
  Write("prior.json", R"({"holds": "depth", "unit": 0.001, "notes": "scan"})");
  const std::string pfm = Write("depth/a/0001.pfm");
  Write("depth/a/0001.png");
  const std::string png = Write("depth/a/0002.png");
  const std::string confidence = Write("confidence/a/0001.png");
  Sequence sequence = ThreeFrames();
  const Status status = AddPriors(folder(), sequence);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_THAT(sequence.cameras[0].prior, ElementsAre("", pfm, png));
  EXPECT_THAT(sequence.cameras[0].prior_confidence, ElementsAre("", confidence, ""));
  EXPECT_EQ(sequence.cameras[0].prior_format, (PriorFormat{PriorFormat::Holds::kDepth, 0.001, 0, 0}));
  EXPECT_THAT(sequence.cameras[1].prior, IsEmpty());
  EXPECT_EQ(sequence.cameras[1].prior_format, PriorFormat());
}

TEST_F(Guides, AStillIsThePriorOfEveryFrame) {
  Write("prior.json", R"({"holds": "relative-depth", "still": true})");
  const std::string file = Write("depth/b/0000.pfm");
  Sequence sequence = ThreeFrames();
  ASSERT_TRUE(AddPriors(folder(), sequence).ok());
  EXPECT_THAT(sequence.cameras[1].prior, ElementsAre(file, file, file));
}

TEST_F(Guides, AnOutputFolderIsAPrior) {
  const std::string file = Write("depth/b/0001.png");
  const std::string confidence = Write("confidence/b/0001.png");
  const std::string digest(64, 'a');
  DepthManifestCamera entry{
      .camera = SmallCamera("b"), .z_near = 2, .z_far = 9, .files = {}, .confidence = {}, .input_sha256 = {digest}};
  entry.files = {{DepthFileName("b", 1), digest}};
  entry.confidence = {{ConfidenceFileName("b", 1), digest}};
  DepthManifest manifest;
  manifest.sequence = "s";
  manifest.first_frame = 1;
  manifest.cameras = {entry};
  ASSERT_TRUE(WriteDepthManifest(folder(), manifest).ok());
  Sequence sequence = ThreeFrames();
  const Status status = AddPriors(folder(), sequence);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_THAT(sequence.cameras[1].prior, ElementsAre("", file, ""));
  EXPECT_THAT(sequence.cameras[1].prior_confidence, ElementsAre("", confidence, ""));
  EXPECT_EQ(sequence.cameras[1].prior_format, (PriorFormat{PriorFormat::Holds::kCodes, 1, 2, 9}));

  // A folder of metric maps holds depth.
  const std::string metric = Write("depth/b/0001.exr");
  manifest.cameras[0].files = {{DepthFileName("b", 1, "exr"), digest}};
  ASSERT_TRUE(WriteDepthManifest(folder(), manifest).ok());
  ASSERT_TRUE(AddPriors(folder(), sequence).ok());
  EXPECT_THAT(sequence.cameras[1].prior, ElementsAre("", metric, ""));
  EXPECT_EQ(sequence.cameras[1].prior_format, PriorFormat{.holds = PriorFormat::Holds::kDepth});
}

TEST_F(Guides, WrongPriorsAreExplained) {
  Sequence sequence = ThreeFrames();
  const auto message = [&] { return AddPriors(folder(), sequence).message(); };
  EXPECT_THAT(AddPriors(folder() + "/none", sequence).message(), HasSubstr("is no folder"));
  EXPECT_THAT(message(), HasSubstr("neither depth.json (an output folder) nor prior.json"));
  Write("prior.json", R"({"holds": "disparity"})");
  EXPECT_THAT(message(), HasSubstr("expected depth, inverse-depth or relative-depth"));
  Write("prior.json", R"({"holds": "depth", "unit": -1})");
  EXPECT_THAT(message(), HasSubstr("unit"));
  Write("prior.json", R"({"holds": "relative-depth", "unit": 2})");
  EXPECT_THAT(message(), HasSubstr("relative-depth has none"));
  Write("prior.json", R"({"holds": "depth", "still": 1})");
  EXPECT_THAT(message(), HasSubstr("expected true or false"));
  Write("prior.json", R"({"holds": "depth", "scale": 1})");
  EXPECT_THAT(message(), HasSubstr("scale"));
  Write("prior.json", R"({"holds": "depth"})");
  EXPECT_THAT(message(), HasSubstr("has no depth of any camera of the sequence (a, b): expected files such as "
                                   "depth/a/0000.pfm"));
}

TEST_F(Guides, MasksReplaceThoseOfTheSequence) {
  const std::string mask = Write("a/0002.png");
  Sequence sequence = ThreeFrames();
  ASSERT_TRUE(AddMasks(folder(), sequence).ok());
  EXPECT_THAT(sequence.cameras[0].masks, ElementsAre("", "", mask));
  EXPECT_THAT(sequence.cameras[1].masks, ElementsAre("", "", ""));
}

TEST_F(Guides, AFolderWithoutMasksIsAnError) {
  Sequence sequence = ThreeFrames();
  EXPECT_THAT(AddMasks(folder(), sequence).message(), HasSubstr("expected files such as a/0000.png"));
}

}  // namespace
}  // namespace depthfarm
