#include "worker/execution/output_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/sequence/depth_manifest.h"
#include "tests/support/plane_scene.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

OutputFile FileOf(const std::string& path, const std::string& content) {
  return {.path = path, .sha256 = Sha256(content), .bytes = content.size()};
}

class OutputFolderTest : public testing::Test {
 protected:
  std::string Content(const std::string& path) { return ReadFileBytes((dir_ / path).string(), 1000).value(); }
  void Write(const fs::path& path, const std::string& content) {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << content;
  }

  // As a later run of a job sees the folder.
  [[nodiscard]] OutputFolder Run(std::uint64_t run, const StillLeased& still_leased = {}) const {
    return OutputFolder::At(dir_.string(), OutputContent::kDepth, {run, still_leased}).value();
  }

  testing_support::TemporaryFolder temporary_;
  fs::path dir_ = temporary_.path() / "out";
  OutputFolder folder_ = Run(1);
};

TEST_F(OutputFolderTest, IsAnAbsoluteFolderOfItsOwn) {
  for (const char* dir : {"", "out", "./out", "/", "/a/../b", "/a/.."}) {
    EXPECT_EQ(OutputFolder::At(dir).status().code(), ErrorCode::kInvalidArgument) << dir;
  }
}

TEST_F(OutputFolderTest, MovesStagedFilesIntoPlace) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("f0-a1", "depth/cam0/0000.png", "depth").ok());
  EXPECT_FALSE(fs::exists(dir_ / "depth"));
  ASSERT_TRUE(folder_.Commit("f0-a1", {FileOf("depth/cam0/0000.png", "depth")}).ok());
  EXPECT_EQ(Content("depth/cam0/0000.png"), "depth");
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-staging/f0-a1"));
}

TEST_F(OutputFolderTest, AJobThatGoesOnKeepsItsFiles) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("f0-a1", "depth/cam0/0000.png", "depth").ok());
  const std::vector<OutputFile> files{FileOf("depth/cam0/0000.png", "depth")};
  ASSERT_TRUE(folder_.Commit("f0-a1", files).ok());
  ASSERT_TRUE(folder_.Stage("f1-a1", "depth/cam0/0001.png", "half").ok());
  const OutputFolder second = Run(2);
  ASSERT_TRUE(second.Resume(files).ok());
  EXPECT_EQ(Content("depth/cam0/0000.png"), "depth");
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-staging"));
  // Its manifest may have been written before the coordinator was lost.
  ASSERT_TRUE(second.Finish("{}").ok());
  const OutputFolder third = Run(3);
  ASSERT_TRUE(third.Resume(files).ok());
  EXPECT_FALSE(fs::exists(dir_ / "depth.json"));
  EXPECT_TRUE(third.Stage("f1-a2", "depth/cam0/0001.png", "more").ok());
}

TEST_F(OutputFolderTest, AJobDoesNotGoOnWithFilesThatAreNotItsOwn) {
  const std::vector<OutputFile> files{FileOf("depth/cam0/0000.png", "depth")};
  const OutputFolder second = Run(2);
  EXPECT_THAT(second.Resume(files).message(), HasSubstr("belongs to no job any more"));
  ASSERT_TRUE(folder_.Prepare().ok());
  EXPECT_THAT(second.Resume(files).message(), HasSubstr("depth/cam0/0000.png: is missing"));
  Write(dir_ / "depth/cam0/0000.png", "deptH");
  const Status other = second.Resume(files);
  EXPECT_EQ(other.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(other.message(), HasSubstr("is not what the job wrote"));
  EXPECT_EQ(second.Resume({FileOf("../x", "depth")}).code(), ErrorCode::kInvalidArgument);
}

TEST_F(OutputFolderTest, ACommitMayBeRepeated) {
  ASSERT_TRUE(folder_.Prepare().ok());
  const std::vector<OutputFile> files{FileOf("depth/a/0.png", "one"), FileOf("depth/b/0.png", "two")};
  ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "one").ok());
  ASSERT_TRUE(folder_.Stage("s", "depth/b/0.png", "two").ok());
  ASSERT_TRUE(folder_.Commit("s", files).ok());
  EXPECT_TRUE(folder_.Commit("s", files).ok());
  EXPECT_EQ(Content("depth/b/0.png"), "two");
}

TEST_F(OutputFolderTest, ACommitGoesOnWhereAnotherOneDied) {
  ASSERT_TRUE(folder_.Prepare().ok());
  Write(dir_ / "depth/a/0.png", "one");
  ASSERT_TRUE(folder_.Stage("s", "depth/b/0.png", "two").ok());
  EXPECT_TRUE(folder_.Commit("s", {FileOf("depth/a/0.png", "one"), FileOf("depth/b/0.png", "two")}).ok());
}

TEST_F(OutputFolderTest, CommitsNothingButWhatWasEmitted) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "fake").ok());
  EXPECT_EQ(folder_.Commit("s", {FileOf("depth/a/0.png", "true")}).code(), ErrorCode::kCorrupt);
  EXPECT_FALSE(fs::exists(dir_ / "depth/a/0.png"));
  EXPECT_EQ(folder_.Commit("s", {FileOf("depth/b/0.png", "true")}).code(), ErrorCode::kUnavailable);
}

// A depth.json of one camera, with or without a confidence map.
std::string ManifestText(bool confidence) {
  DepthManifestCamera camera;
  camera.camera = ForwardCamera("a", 0, 0, 16, 12, 20);
  camera.z_near = 1;
  camera.z_far = 2;
  camera.files = {{"depth/a/0.png", std::string(64, '0')}};
  camera.input_sha256 = {std::string(64, '0')};
  if (confidence) camera.confidence = {{"confidence/a/0.png", std::string(64, '0')}};
  DepthManifest manifest;
  manifest.cameras = {camera};
  return FormatDepthManifest(manifest).value();
}

TEST_F(OutputFolderTest, ConfidenceGoesBesideTheDepthAndWithIt) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("s", "confidence/a/0.png", "sure").ok());
  ASSERT_TRUE(folder_.Commit("s", {FileOf("confidence/a/0.png", "sure")}).ok());
  EXPECT_EQ(Content("confidence/a/0.png"), "sure");
  ASSERT_TRUE(folder_.Finish(ManifestText(true)).ok());
  ASSERT_TRUE(Run(2).Prepare().ok());
  EXPECT_FALSE(fs::exists(dir_ / "confidence")) << "the next job begins anew";
}

TEST_F(OutputFolderTest, RefusesAFolderWithSomebodyElsesConfidence) {
  Write(dir_ / "confidence/mine", "x");
  EXPECT_THAT(folder_.Prepare().message(), HasSubstr("confidence: exists and was not made by depthfarm"));
  EXPECT_EQ(Content("confidence/mine"), "x");
}

TEST_F(OutputFolderTest, OurDepthDoesNotMakeConfidenceOurs) {
  Write(dir_ / "depth/a/0.png", "ours");
  Write(dir_ / "depth.json", ManifestText(false));
  Write(dir_ / "confidence/mine", "x");
  EXPECT_THAT(folder_.Prepare().message(), HasSubstr("confidence: exists and was not made by depthfarm"));
  EXPECT_EQ(Content("confidence/mine"), "x");
  EXPECT_EQ(Content("depth/a/0.png"), "ours") << "nothing is removed by half";
}

TEST_F(OutputFolderTest, NoPathLeavesTheFolder) {
  ASSERT_TRUE(folder_.Prepare().ok());
  for (const char* path : {"../x/0.png", "depth/../0.png", "/etc/x/0.png", "depth", "depth/a/", "/a", "depth/a/..",
                           "depth/0.png", "depth//0.png", "depth/a/b/0.png", "depth/a/x\n", "views/a/0.png", ""}) {
    EXPECT_EQ(folder_.Stage("s", path, "").code(), ErrorCode::kInvalidArgument) << path;
    EXPECT_EQ(folder_.Commit("s", {FileOf(path, "")}).code(), ErrorCode::kInvalidArgument) << path;
  }
  for (const char* staging : {"", ".", "..", "../..", "a/b", "/a"}) {
    EXPECT_EQ(folder_.Stage(staging, "depth/a/0.png", "").code(), ErrorCode::kInvalidArgument) << staging;
    EXPECT_EQ(folder_.Commit(staging, {}).code(), ErrorCode::kInvalidArgument) << staging;
  }
}

TEST_F(OutputFolderTest, RefusesAFolderWithSomebodyElsesDepth) {
  Write(dir_ / "depth/precious.png", "mine");
  const Status prepared = folder_.Prepare();
  EXPECT_EQ(prepared.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(prepared.message(), HasSubstr("choose another folder"));
  EXPECT_EQ(Content("depth/precious.png"), "mine");
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-job"));
}

TEST_F(OutputFolderTest, ReplacesAnEarlierResultAndLeavesOtherFilesAlone) {
  Write(dir_ / "depth/cam9/0000.png", "old");
  Write(dir_ / "depth.json", "{}");
  Write(dir_ / "notes.txt", "mine");
  ASSERT_TRUE(folder_.Prepare().ok());
  EXPECT_FALSE(fs::exists(dir_ / "depth"));
  EXPECT_FALSE(fs::exists(dir_ / "depth.json"));
  EXPECT_EQ(Content("notes.txt"), "mine");
}

TEST_F(OutputFolderTest, TakesOverTheFolderOfAJobThatFailed) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "one").ok());
  ASSERT_TRUE(folder_.Commit("s", {FileOf("depth/a/0.png", "one")}).ok());
  ASSERT_TRUE(folder_.Stage("t", "depth/a/1.png", "two").ok());
  ASSERT_TRUE(folder_.RemoveStaging().ok());
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-staging"));
  EXPECT_TRUE(Run(2).Prepare().ok());
  EXPECT_FALSE(fs::exists(dir_ / "depth"));
}

TEST_F(OutputFolderTest, APrepareThatComesLateRemovesNothing) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "one").ok());
  ASSERT_TRUE(folder_.Commit("s", {FileOf("depth/a/0.png", "one")}).ok());
  EXPECT_TRUE(folder_.Prepare().ok()) << "another attempt of it has done it";
  EXPECT_EQ(Content("depth/a/0.png"), "one");
}

TEST_F(OutputFolderTest, APrepareGoesOnWhereAnotherOneDied) {
  Write(dir_ / "depth.json", "{}");
  Write(dir_ / "depth/a/0.png", "old");
  int looks = 0;
  const Status died = Run(1, [&looks] { return ++looks <= 2; }).Prepare();
  EXPECT_EQ(died.code(), ErrorCode::kLeaseExpired);
  EXPECT_EQ(folder_.Stage("s", "depth/a/0.png", "new").code(), ErrorCode::kOk);
  EXPECT_TRUE(fs::exists(dir_ / "depth/a/0.png"));
  ASSERT_TRUE(folder_.Prepare().ok());
  EXPECT_FALSE(fs::exists(dir_ / "depth"));
}

// Whatever a worker is at when it stands still: when it goes on, others have the folder, and notice nothing.
TEST_F(OutputFolderTest, WhoseLeaseIsOverChangesNothing) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "one").ok());
  ASSERT_TRUE(folder_.Stage("late", "depth/a/1.png", "two").ok());
  ASSERT_TRUE(folder_.Commit("s", {FileOf("depth/a/0.png", "one")}).ok());
  const auto all = [this] {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir_))
      if (entry.is_regular_file()) files[entry.path().string()] = ReadFileBytes(entry.path().string(), 1000).value();
    return files;
  };
  const auto before = all();
  for (const std::uint64_t run : {1, 2}) {
    const OutputFolder late = Run(run, [] { return false; });
    if (run == 2) {
      EXPECT_EQ(late.Prepare().code(), ErrorCode::kLeaseExpired);
    }
    EXPECT_FALSE(late.Stage("more", "depth/a/2.png", "three").ok());
    EXPECT_FALSE(late.Commit("late", {FileOf("depth/a/1.png", "two")}).ok());
    EXPECT_FALSE(late.Finish("{}").ok());
    EXPECT_EQ(late.RemoveStaging().code(), ErrorCode::kLeaseExpired);
    EXPECT_EQ(all(), before) << "run " << run;
  }
}

// The first run stands still at each of its looks at the lease in turn; meanwhile a second run takes the folder and
// ends.
TEST_F(OutputFolderTest, WhoStandsStillAtAnyStepChangesNothingOfALaterResult) {
  const auto all = [this] {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir_))
      files[entry.path().string()] =
          entry.is_regular_file() ? ReadFileBytes(entry.path().string(), 1000).value() : "a folder";
    return files;
  };
  const std::vector<OutputFile> files{FileOf("depth/a/0.png", "one"), FileOf("depth/a/1.png", "two")};
  const std::map<std::string, std::function<Status(const OutputFolder&)>> tasks{
      {"Prepare", [](const OutputFolder& folder) { return folder.Prepare(); }},
      {"Stage", [](const OutputFolder& folder) { return folder.Stage("more", "depth/a/2.png", "three"); }},
      {"Commit", [&](const OutputFolder& folder) { return folder.Commit("s", files); }},
      {"Finish", [](const OutputFolder& folder) { return folder.Finish("{\"old\": 1}"); }},
      {"RemoveStaging", [](const OutputFolder& folder) { return folder.RemoveStaging(); }}};
  for (const auto& [name, task] : tasks) {
    int looks_in_all = 1;
    for (int still_at = 1; still_at <= looks_in_all; ++still_at) {
      SCOPED_TRACE(name + ", look " + std::to_string(still_at));
      fs::remove_all(dir_);
      if (name == "Prepare") {
        Write(dir_ / "depth.json", "{}");
        Write(dir_ / "depth/a/0.png", "older");
      } else {
        ASSERT_TRUE(folder_.Prepare().ok());
        ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "one").ok());
        ASSERT_TRUE(folder_.Stage("s", "depth/a/1.png", "two").ok());
      }
      int looks = 0;
      std::map<std::string, std::string> result;
      const Status late = task(Run(1, [&] {
        if (++looks != still_at) return looks < still_at;
        const OutputFolder second = Run(2);
        EXPECT_TRUE(second.Prepare().ok());
        EXPECT_TRUE(second.Stage("s", "depth/a/0.png", "new").ok());
        EXPECT_TRUE(second.Commit("s", {FileOf("depth/a/0.png", "new")}).ok());
        EXPECT_TRUE(second.Finish("{\"new\": 1}").ok());
        result = all();
        return false;
      }));
      EXPECT_FALSE(late.ok());
      EXPECT_EQ(all(), result);
      EXPECT_EQ(Content("depth.json"), "{\"new\": 1}");
      // How often it would have looked.
      if (still_at > 1) continue;
      fs::remove_all(dir_);
      ASSERT_TRUE(folder_.Prepare().ok());
      ASSERT_TRUE(folder_.Stage("s", "depth/a/0.png", "one").ok());
      ASSERT_TRUE(folder_.Stage("s", "depth/a/1.png", "two").ok());
      if (name == "Prepare") {
        fs::remove_all(dir_);
        Write(dir_ / "depth.json", "{}");
        Write(dir_ / "depth/a/0.png", "older");
      }
      looks_in_all = 0;
      EXPECT_TRUE(task(Run(1, [&looks_in_all] { return ++looks_in_all > 0; })).ok());
      EXPECT_GT(looks_in_all, 0);
    }
  }
}

TEST_F(OutputFolderTest, ATaskOfAnEarlierRunLeavesTheFolderOfALaterOneAlone) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Stage("old", "depth/a/0.png", "old").ok());
  const OutputFolder second = Run(2);
  ASSERT_TRUE(second.Prepare().ok());
  ASSERT_TRUE(second.Stage("new", "depth/a/0.png", "new").ok());
  EXPECT_THAT(folder_.Stage("old", "depth/a/0.png", "old").message(), HasSubstr("belongs to another job by now"));
  EXPECT_EQ(folder_.Commit("new", {FileOf("depth/a/0.png", "new")}).code(), ErrorCode::kUnavailable);
  EXPECT_EQ(folder_.Finish("{}").code(), ErrorCode::kUnavailable);
  EXPECT_TRUE(second.Commit("new", {FileOf("depth/a/0.png", "new")}).ok());
  EXPECT_TRUE(second.Finish("{}").ok());
  EXPECT_TRUE(second.Finish("{}").ok()) << "may be repeated";
  EXPECT_EQ(folder_.Finish("{\"old\": 1}").code(), ErrorCode::kUnavailable);
  EXPECT_EQ(Content("depth.json"), "{}");
}

TEST_F(OutputFolderTest, WhatADeadWorkerWasRemovingGoesWithTheNextJob) {
  Write(dir_ / ".depthfarm-removed-17-1/depth/a/0.png", "old");
  Write(dir_ / "depth.json.tmp-17-1", "{");
  Write(dir_ / ".depthfarm-job.tmp-17-2", "a");
  ASSERT_TRUE(folder_.Prepare().ok());
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-removed-17-1"));
  EXPECT_FALSE(fs::exists(dir_ / "depth.json.tmp-17-1"));
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-job.tmp-17-2"));
}

TEST_F(OutputFolderTest, AnAttemptThatOutlivesItsJobWritesNothing) {
  ASSERT_TRUE(folder_.Prepare().ok());
  ASSERT_TRUE(folder_.Finish("{}\n").ok());
  EXPECT_TRUE(fs::exists(dir_ / "depth.json"));
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-job"));
  EXPECT_EQ(folder_.Stage("late", "depth/a/0.png", "old").code(), ErrorCode::kUnavailable);
  EXPECT_FALSE(fs::exists(dir_ / ".depthfarm-staging"));
}

TEST_F(OutputFolderTest, ViewsHaveTheirOwnFolderAndLeaveDepthAlone) {
  Write(dir_ / "depth.json", "{}");
  Write(dir_ / "depth/a/0.png", "depth");
  Write(dir_ / "views.json", "{}");
  Write(dir_ / "views/0000.png", "old");
  const OutputFolder views = OutputFolder::At(dir_.string(), OutputContent::kViews).value();
  ASSERT_TRUE(views.Prepare().ok());
  EXPECT_FALSE(fs::exists(dir_ / "views"));
  ASSERT_TRUE(views.Stage("p0", "views/0000.png", "new").ok());
  EXPECT_EQ(views.Stage("p0", "depth/0000.png", "new").code(), ErrorCode::kInvalidArgument);
  ASSERT_TRUE(views.Commit("p0", {FileOf("views/0000.png", "new")}).ok());
  ASSERT_TRUE(views.Finish("{\"views\": []}\n").ok());
  EXPECT_EQ(Content("views/0000.png"), "new");
  EXPECT_EQ(Content("views.json"), "{\"views\": []}\n");
  EXPECT_EQ(Content("depth/a/0.png"), "depth");
  EXPECT_EQ(Content("depth.json"), "{}");
}

TEST_F(OutputFolderTest, AViewsJobThatWasCancelledDoesNotMakeForeignDepthOurs) {
  Write(dir_ / "depth/mine.png", "mine");
  const OutputFolder views = OutputFolder::At(dir_.string(), OutputContent::kViews).value();
  ASSERT_TRUE(views.Prepare().ok());
  ASSERT_TRUE(views.RemoveStaging().ok());
  EXPECT_EQ(folder_.Prepare().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(Content("depth/mine.png"), "mine");
  EXPECT_TRUE(views.Prepare().ok());
}

TEST_F(OutputFolderTest, ForeignViewsAreNotRemoved) {
  Write(dir_ / "views/0000.png", "mine");
  const Status prepared = OutputFolder::At(dir_.string(), OutputContent::kViews).value().Prepare();
  EXPECT_EQ(prepared.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(prepared.message(), HasSubstr("no views.json beside it"));
  EXPECT_EQ(Content("views/0000.png"), "mine");
}

TEST_F(OutputFolderTest, SaysWhichPathItCannotWrite) {
  Write(dir_, "a file, not a folder");
  const Status prepared = folder_.Prepare();
  EXPECT_EQ(prepared.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(prepared.message(), HasSubstr(dir_.string()));
}

}  // namespace
}  // namespace depthfarm
