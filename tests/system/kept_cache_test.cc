// What `depthfarm run` keeps for the next one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): setenv is POSIX

#include <map>

#include "common/files/atomic_file.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Counts {
  int total = 0;
  int reused = 0;
  bool operator==(const Counts&) const = default;
};

// Of a run's --json.
Counts TasksOf(const Outcome& run) {
  Counts counts;
  const nlohmann::json report = ParseJsonTail(run.output);
  for (const nlohmann::json& stage : report.at("stages")) {
    // What is written into the output folder is of each run.
    if (const std::string name = stage.at("stage"); name != "analyse" && name != "estimate" && name != "refine")
      continue;
    counts.total += stage.at("tasksTotal").get<int>();
    counts.reused += stage.at("reused").get<int>();
  }
  return counts;
}

class KeptCache : public testing::Test {
 protected:
  void SetUp() override {
    sequence_ = RenderScene(folder_.path() / "scene");
    CacheHome(folder_ / "user");
  }
  void TearDown() override { ::unsetenv("XDG_CACHE_HOME"); }  // NOLINT(concurrency-mt-unsafe): one thread
  static void CacheHome(const std::string& folder) {
    ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }

  Outcome Run(const std::string& output, const Words& options) {
    return RunProgram("depthfarm", Words{"run", sequence_, "-o", folder_ / output, "--workers", "2", "--json"} +
                                       SmallJob() + options);
  }
  fs::path OfUser() { return folder_.path() / "user" / "depthfarm"; }

  TemporaryFolder folder_;
  std::string sequence_;
};

TEST_F(KeptCache, IsTheUsersAndSparesTheSameWork) {
  const Outcome first = Run("first", {"--frames", "0:2"});
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_EQ(TasksOf(first).reused, 0) << first.output;
  EXPECT_TRUE(fs::is_regular_file(OfUser() / "CACHEDIR.TAG"));
  EXPECT_EQ(fs::status(OfUser() / "artifacts").permissions(), fs::perms::owner_all);

  const Outcome longer = Run("longer", {});
  ASSERT_EQ(longer.exit_code, 0) << longer.output;
  EXPECT_EQ(TasksOf(longer).reused, TasksOf(first).total) << longer.output;
  const Outcome again = Run("again", {"--threads", "2"});
  ASSERT_EQ(again.exit_code, 0) << again.output;
  EXPECT_EQ(TasksOf(again).reused, TasksOf(longer).total) << again.output;

  const Outcome anew = Run("anew", {"--no-cache"});
  ASSERT_EQ(anew.exit_code, 0) << anew.output;
  EXPECT_EQ(TasksOf(anew), (Counts{TasksOf(longer).total, 0})) << anew.output;
  for (const char* kept : {"longer", "again"})
    EXPECT_THAT(Differences(DepthOf(folder_ / "anew"), DepthOf(folder_ / kept)), IsEmpty()) << kept;
}

TEST_F(KeptCache, AnotherOutputFormatComputesNothingAnewAndLeavesNoMix) {
  const Outcome png = Run("png", {});
  ASSERT_EQ(png.exit_code, 0) << png.output;
  for (const char* format : {"exr", "pfm", "yuv420p16"}) {
    const Outcome run = Run("out", {"--output-format", format});
    ASSERT_EQ(run.exit_code, 0) << run.output;
    EXPECT_EQ(TasksOf(run), (Counts{TasksOf(png).total, TasksOf(png).total})) << run.output;
    // The same depth: as a video of codes it is the same file.
    for (const char* of : {"png", "out"})
      ASSERT_EQ(Depthfarm({"export", "yuv", folder_ / of, "-o", folder_ / (std::string(of) + "-yuv")}).exit_code, 0);
    for (const char* file : {"cam0.yuv", "cam1.yuv", "cameras.json"}) {
      EXPECT_TRUE(ReadFileBytes(folder_ / ("png-yuv/" + std::string(file)), 1 << 24).value() ==
                  ReadFileBytes(folder_ / ("out-yuv/" + std::string(file)), 1 << 24).value())
          << format << " " << file;
    }
    EXPECT_EQ(Depthfarm({"verify", folder_ / "out"}).exit_code, 0);
    const std::string extension = "." + std::string(format).substr(0, 3);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / "out/depth")) {
      if (entry.is_regular_file()) {
        EXPECT_EQ(entry.path().extension(), extension) << entry.path();
      }
    }
  }
  const Outcome wrong = Run("out", {"--output-format", "png"});
  EXPECT_EQ(wrong.exit_code, 2) << wrong.output;
  EXPECT_THAT(wrong.output, HasSubstr("output-format is 'png', expected png16, pfm, exr or yuv420p16"));
}

TEST_F(KeptCache, IsAnotherFolderOnRequest) {
  const Words named = {"--frames", "0:1", "--cache-dir", folder_ / "named/below", "--cache-size", "100MB"};
  ASSERT_EQ(Run("out", named).exit_code, 0);
  EXPECT_FALSE(fs::exists(OfUser()));
  EXPECT_TRUE(fs::exists(folder_ / "named/below/lock"));
  const Outcome again = Run("out", named);
  EXPECT_EQ(TasksOf(again).reused, TasksOf(again).total) << again.output;
}

TEST_F(KeptCache, IsDoneWithoutWhereThereCanBeNone) {
  CacheHome("/proc/nothing");
  const Outcome run = Run("out", {"--frames", "0:1"});
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("nothing is kept for the next run in /proc/nothing/depthfarm/artifacts"),
                                HasSubstr("--cache-dir names another folder")));
  EXPECT_THAT(Run("out", {"--frames", "0:1", "--no-cache"}).output, Not(HasSubstr("nothing is kept")));
}

TEST_F(KeptCache, CannotBeAFile) {
  const Outcome run = Run("out", {"--cache-dir", sequence_});
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("--cache-dir"), HasSubstr(sequence_)));
  EXPECT_FALSE(fs::exists(folder_ / "out/depth.json"));
}

}  // namespace
}  // namespace depthfarm::system_test
