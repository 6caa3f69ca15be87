// Virtual views as tasks of a farm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Name -> bytes of the pictures directly in `folder`.
std::map<std::string, std::string> PicturesIn(const fs::path& folder) {
  std::map<std::string, std::string> pictures;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".png") pictures[entry.path().filename().string()] = ReadFile(entry.path());
  }
  return pictures;
}

class ViewsOnAFarm : public testing::Test {
 protected:
  void SetUp() override {
    sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 4});
    const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "depth", "--workers", "2"} + SmallJob());
    ASSERT_EQ(run.exit_code, 0) << run.output;
  }

  [[nodiscard]] Words Synthesize(const std::string& output) const {
    return {"synthesize", sequence_, folder_ / "depth",     "-o", folder_ / output, "--path",
            "cam0,cam2",  "--steps", std::to_string(kSteps)};
  }
  std::uint64_t Submit(Farm& farm, const std::string& output) {
    const Outcome submitted = Depthfarm(Synthesize(output) + Words{"--submit"} + farm.Options());
    EXPECT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
    return submitted.exit_code == 0 ? std::stoull(submitted.output) : 0;
  }
  v1::JobStatus WaitForTheEnd(Farm& farm, std::uint64_t job_id) {
    v1::JobStatus last;
    EXPECT_TRUE(WaitUntil([&] {
      const Result<v1::JobStatus> job = farm.client().GetStatus(job_id);
      if (job.ok()) last = *job;
      return job.ok() && last.state() != v1::JOB_STATE_RUNNING;
    })) << farm.Logs();
    return last;
  }

  static constexpr int kSteps = 60;
  TemporaryFolder folder_;
  std::string sequence_;
};

TEST_F(ViewsOnAFarm, AreTheBytesOfALocalRunThoughAWorkerIsKilled) {
  const Outcome local = Depthfarm(Synthesize("local"));
  ASSERT_EQ(local.exit_code, 0) << local.output;
  const auto expected = PicturesIn(folder_ / "local");
  ASSERT_THAT(expected, SizeIs(kSteps));

  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const int victim = farm.AddWorker();
  const std::uint64_t job_id = Submit(farm, "farm");
  ASSERT_TRUE(WaitUntil([&] {
    const Result<v1::JobStatus> job = farm.client().GetStatus(job_id);
    return job.ok() && job->frames_done() > 0;
  })) << farm.Logs();
  farm.worker(victim).Signal(SIGKILL);
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  ASSERT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
  EXPECT_EQ(last.frames_done(), kSteps);
  EXPECT_EQ(last.frames_total(), kSteps);
  EXPECT_THAT(last.summary(), HasSubstr("60 virtual views, 160x120"));
  EXPECT_THAT(Differences(expected, PicturesIn(fs::path(folder_ / "farm") / "views")), IsEmpty());
  EXPECT_THAT(Leftovers(folder_ / "farm"), IsEmpty());

  const nlohmann::json manifest = nlohmann::json::parse(ReadFile(fs::path(folder_ / "farm") / "views.json"));
  ASSERT_THAT(manifest["views"], SizeIs(kSteps));
  EXPECT_EQ(manifest["views"][7]["file"], "views/0007.png");
  EXPECT_EQ(manifest["views"][7]["frame"], 3);  // the last frame stays
  EXPECT_EQ(manifest["views"][7]["from"].size(), 2U);
}

TEST_F(ViewsOnAFarm, AJobOfOtherDepthThanItWasSubmittedWithFails) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const std::uint64_t job_id = Submit(farm, "stale");
  const Outcome again = Depthfarm(Words{"run", sequence_, "-o", folder_ / "depth", "--workers", "2", "--levels", "16",
                                        "--frames", "0:4", "--segments", "200"});
  ASSERT_EQ(again.exit_code, 0) << again.output;
  farm.AddWorker();
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  EXPECT_EQ(last.state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(last.error().message(), HasSubstr("depth.json is not the one the job was submitted with"));
  EXPECT_FALSE(fs::exists(fs::path(folder_ / "stale") / "views.json"));
}

TEST_F(ViewsOnAFarm, SaysWhatIsWrong) {
  const auto failure = [&](const Words& words) {
    const Outcome outcome = Depthfarm(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    return outcome.output;
  };
  EXPECT_THAT(failure(Synthesize("a.mp4") + Words{"--submit"}), HasSubstr("a farm writes PNG pictures"));
  EXPECT_THAT(failure(Synthesize("a") + Words{"--coordinator", "tcp://127.0.0.1:1"}), HasSubstr("--submit"));
  EXPECT_THAT(failure(Synthesize("a") + Words{"--submit", "--threads", "3"}), HasSubstr("--threads"));
  fs::create_directories(fs::path(folder_ / "foreign") / "views");
  EXPECT_THAT(failure(Synthesize("foreign") + Words{"--submit"}), HasSubstr("that no job of depthfarm made"));
  const Outcome nobody = Depthfarm(
      Synthesize("a") + Words{"--submit", "--insecure", "--coordinator", "tcp://127.0.0.1:1", "--timeout", "0.2"});
  EXPECT_EQ(nobody.exit_code, 3) << nobody.output;
}

}  // namespace
}  // namespace depthfarm::system_test
