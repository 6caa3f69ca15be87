#include "common/sequence/output_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/output_layout.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A finished folder of one camera with two frames.
class OutputCheckTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(path("depth/cam0"));
    DepthManifestCamera camera;
    camera.camera.name = "cam0";
    camera.camera.width = camera.camera.height = 16;
    camera.camera.intrinsics << 20, 0, 7.5, 0, 20, 7.5, 0, 0, 1;
    camera.z_near = 1;
    camera.z_far = 2;
    for (const char* content : {"first", "second"}) {
      const std::string file = DepthFileName("cam0", static_cast<int>(camera.files.size()));
      Write(file, content);
      camera.files.push_back({file, Hex(Sha256(content))});
      camera.input_sha256.push_back(Hex(Sha256("picture")));
    }
    ASSERT_TRUE(WriteDepthManifest(folder_.path().string(), {"s", 1, 0, {}, {camera}}).ok());
  }
  [[nodiscard]] std::string path(const std::string& file) const { return (folder_.path() / file).string(); }
  void Write(const std::string& file, const std::string& content) {
    ASSERT_TRUE(WriteFileAtomically(path(file), content).ok());
  }
  [[nodiscard]] OutputCheck Check() const {
    return CheckOutput(folder_.path().string(), [] { return false; }).value();
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(OutputCheckTest, AFinishedFolderIsGood) {
  const OutputCheck check = Check();
  EXPECT_TRUE(check.good());
  EXPECT_EQ(check.files, 2U);
  EXPECT_EQ(check.bytes, 11U);
  EXPECT_THAT(check.manifests, ElementsAre("depth.json"));
}

TEST_F(OutputCheckTest, NamesMissingAndChangedFiles) {
  fs::remove(path("depth/cam0/0000.png"));
  Write("depth/cam0/0001.png", "seconD");
  const OutputCheck check = Check();
  EXPECT_FALSE(check.good());
  EXPECT_THAT(check.missing, ElementsAre("depth/cam0/0000.png"));
  EXPECT_THAT(check.changed, ElementsAre("depth/cam0/0001.png"));
}

TEST_F(OutputCheckTest, WhatIsThereAndCannotBeReadIsNotMissing) {
  fs::remove(path("depth/cam0/0000.png"));
  fs::create_directory(path("depth/cam0/0000.png"));
  fs::remove(path("depth/cam0/0001.png"));
  fs::create_symlink("nowhere", path("depth/cam0/0001.png"));
  const OutputCheck check = Check();
  EXPECT_FALSE(check.good());
  EXPECT_THAT(check.unreadable, ElementsAre("depth/cam0/0000.png", "depth/cam0/0001.png"));
  EXPECT_THAT(check.missing, IsEmpty());
}

TEST_F(OutputCheckTest, NamesFilesThatNoManifestNames) {
  fs::create_directories(path("depth/cam9"));
  Write("depth/cam9/0000.png", "old");
  Write("depth/cam0/0002.png", "old");
  Write("run.json", "{}");  // not in a folder of the manifest
  const OutputCheck check = Check();
  EXPECT_FALSE(check.good());
  EXPECT_THAT(check.unlisted, ElementsAre("depth/cam0/0002.png", "depth/cam9/0000.png"));
}

TEST_F(OutputCheckTest, AJobThatOwnsTheFolderIsSaid) {
  Write(kDepthJobMarker, "");
  EXPECT_TRUE(Check().unfinished);
  EXPECT_FALSE(Check().good());
}

TEST_F(OutputCheckTest, ChecksVirtualViewsToo) {
  fs::create_directories(path("views"));
  Write("views/0000.png", "view");
  Write("views/0001.png", "other");
  Write("views.json", R"({"format": "depthfarm-views-1", "views": [{"file": "views/0000.png", "sha256": ")" +
                          Hex(Sha256("view")) + "\"}]}");
  const OutputCheck check = Check();
  EXPECT_EQ(check.files, 3U);
  EXPECT_THAT(check.manifests, ElementsAre("depth.json", "views.json"));
  EXPECT_THAT(check.unlisted, ElementsAre("views/0001.png"));
}

TEST_F(OutputCheckTest, AViewOutsideTheFolderIsRefused) {
  for (const char* file : {"/etc/passwd", "../x", "views/../../x", ""}) {
    Write("views.json", std::string(R"({"views": [{"file": ")") + file + R"(", "sha256": "00"}]})");
    const auto check = CheckOutput(folder_.path().string(), [] { return false; });
    EXPECT_EQ(check.status().code(), ErrorCode::kInvalidArgument) << file;
  }
}

TEST_F(OutputCheckTest, WithoutAManifestItSaysWhy) {
  fs::remove(path("depth.json"));
  const auto message = [&] { return CheckOutput(folder_.path().string(), [] { return false; }).status().message(); };
  EXPECT_THAT(message(), HasSubstr("no job of depthfarm"));
  Write(kDepthJobMarker, "");
  EXPECT_THAT(message(), HasSubstr("its job runs, or ended before it was done"));
  EXPECT_THAT(CheckOutput(path("nowhere"), [] { return false; }).status().message(), HasSubstr("is no folder"));
}

TEST_F(OutputCheckTest, StopsWhenAsked) {
  EXPECT_EQ(CheckOutput(folder_.path().string(), [] { return true; }).status().code(), ErrorCode::kCancelled);
}

}  // namespace
}  // namespace depthfarm
