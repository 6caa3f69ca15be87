// What `depthfarm logs` tells of jobs that went well and badly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class Logs : public testing::Test {
 protected:
  void SetUp() override { sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 2}); }

  // The picture of a camera in frame 1 ends in the middle; its header is right.
  void TruncateAPicture() {
    const fs::path picture = folder_.path() / "scene" / "cam1" / "0001.png";
    fs::resize_file(picture, fs::file_size(picture) / 2);
  }

  TemporaryFolder folder_;
  std::string sequence_;
};

TEST_F(Logs, OfADoneJobHaveEveryAttempt) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--name", "w1"});
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  EXPECT_THAT(submitted.output, Not(HasSubstr("depthfarm logs")));

  const Outcome told = Depthfarm(Words{"logs", "1", "--json"} + farm.Options());
  ASSERT_EQ(told.exit_code, 0) << told.output;
  const nlohmann::json logs = ParseJsonTail(told.output);
  EXPECT_EQ(logs["attemptsForgotten"], 0);
  std::uint64_t tasks = 0;
  const Result<v1::JobStatus> job = farm.client().GetStatus(1);
  ASSERT_TRUE(job.ok());
  for (const v1::StageStatus& stage : job->stages()) tasks += stage.tasks_done() - stage.reused();
  EXPECT_EQ(logs["attempts"].size(), tasks);
  double last_start = 0;
  for (const nlohmann::json& attempt : logs["attempts"]) {
    EXPECT_EQ(attempt["outcome"], "done") << attempt;
    EXPECT_EQ(attempt["worker"], "w1");
    EXPECT_TRUE(attempt["error"].is_null());
    EXPECT_GE(attempt["startSeconds"], last_start);
    last_start = attempt["startSeconds"];
  }

  const Outcome one = Depthfarm(Words{"logs", "1", "--task", "estimate frame 1 block 0"} + farm.Options());
  EXPECT_EQ(one.exit_code, 0) << one.output;
  EXPECT_THAT(one.output, HasSubstr("frame 1 estimate block 0  w1"));
  EXPECT_EQ(std::ranges::count(one.output, '\n'), 2) << one.output;

  EXPECT_EQ(Depthfarm(Words{"logs", "1", "--task", "sing"} + farm.Options()).exit_code, 2);
  EXPECT_EQ(Depthfarm(Words{"logs", "7"} + farm.Options()).exit_code, 2);
}

TEST_F(Logs, OfAFailedJobSayWhyAndWhatLibrariesWrote) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--slots", "2"});
  TruncateAPicture();
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + SmallJob() + farm.Options());
  EXPECT_EQ(submitted.exit_code, 2) << submitted.output << farm.Logs();
  EXPECT_THAT(submitted.output, HasSubstr("what happened to its tasks: depthfarm logs 1 --coordinator "));

  const Outcome told = Depthfarm(Words{"logs", "1", "--task", "frame 1 analyse view 1"} + farm.Options());
  EXPECT_EQ(told.exit_code, 0) << told.output;
  EXPECT_THAT(told.output, HasSubstr("failed: invalid_argument\n    reason: camera 'cam1', frame 1: "));
  EXPECT_THAT(told.output, HasSubstr("    | libpng ")) << farm.Logs();

  const nlohmann::json logs = ParseJsonTail(Depthfarm(Words{"logs", "1", "--json"} + farm.Options()).output);
  int failed = 0;
  for (const nlohmann::json& attempt : logs["attempts"]) {
    EXPECT_NE(attempt["outcome"], "running") << attempt;
    if (attempt["outcome"] != "failed") {
      EXPECT_TRUE(attempt["log"].empty()) << "lines of another slot: " << attempt;
      continue;
    }
    ++failed;
    EXPECT_EQ(attempt["task"], "frame 1 analyse view 1");
    EXPECT_EQ(attempt["error"]["code"], "invalid_argument");
    EXPECT_FALSE(attempt["log"].empty());
  }
  EXPECT_EQ(failed, 1);
}

}  // namespace
}  // namespace depthfarm::system_test
