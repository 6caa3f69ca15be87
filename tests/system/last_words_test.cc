// Workers whose process is killed by what it computes, or beside it: what is told of their end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

constexpr const char* kDeadlyTask = "frame 1 analyse view 1";
constexpr const char* kWords = "deadly picture: the heap is not what it was";
constexpr const char* kHow = "was killed by signal 6 (Aborted)";
constexpr int kMaxAttempts = 4;  // of the coordinator, by default

// Pictures of which one kills every worker that opens it.
class DeadlyPicture : public DisturbedJob {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizers must be loaded before anything else";
#endif
    DisturbedJob::SetUp();
    job_ = SmallJob();
    picture_ = (folder_.path() / "scene" / "cam1" / "0001.png").string();
    ASSERT_TRUE(std::filesystem::exists(picture_));
  }
  [[nodiscard]] Words Preload() const {
    return {"/usr/bin/env", std::string("LD_PRELOAD=") + DEPTHFARM_DEADLY_PICTURE,
            "DEPTHFARM_DEADLY_PICTURE=" + picture_};
  }

  std::string picture_;
};

TEST_F(DeadlyPicture, FailsItsJobWithTheLastWordsOfTheWorkersThatItKilled) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  // As a service manager has them: started again under their names.
  std::map<std::string, int> workers;
  const auto start = [&](const std::string& name) { workers[name] = farm.AddWorker({"--name", name}, "", Preload()); };
  start("w1");
  start("w2");
  const std::uint64_t job = Submit(farm, folder_ / "out");
  ASSERT_TRUE(WaitUntil([&] {
    for (const auto& [name, index] : workers) {
      const std::optional<ProcessEnd> end = farm.worker(index).Poll();
      if (!end) continue;
      EXPECT_EQ(end->signal, SIGABRT) << farm.Logs();
      EXPECT_THAT(farm.LogOf(index), HasSubstr(kWords));
      start(name);
      break;
    }
    const Result<v1::JobStatus> status = farm.client().GetStatus(job);
    return status.ok() && status->state() == v1::JOB_STATE_FAILED;
  })) << farm.Logs();

  const Outcome told = Depthfarm(Words{"status", std::to_string(job), "--json"} + farm.Options());
  const nlohmann::json status = ParseJsonTail(told.output);
  EXPECT_EQ(status["failedTask"], kDeadlyTask) << told.output;
  ASSERT_THAT(status["failedAttempts"], SizeIs(kMaxAttempts)) << told.output;
  for (const nlohmann::json& attempt : status["failedAttempts"]) {
    EXPECT_EQ(attempt["outcome"], "worker lost");
    EXPECT_THAT(attempt["error"]["message"].get<std::string>(), HasSubstr(kHow));
    ASSERT_FALSE(attempt["log"].empty()) << told.output;
    EXPECT_EQ(attempt["log"].back(), kWords);
  }
  EXPECT_THAT(ReasonOfFailure(farm, job), testing::AllOf(HasSubstr(kHow), HasSubstr(kWords)));
  const std::string logs = Depthfarm(Words{"logs", std::to_string(job), "--task", kDeadlyTask} + farm.Options()).output;
  EXPECT_THAT(logs, HasSubstr(std::string("    | ") + kWords));
}

TEST_F(DeadlyPicture, HasALocalRunTellTheLastWordsOfItsWorkers) {
  const Words run = {Program("depthfarm").string(), "run", sequence_, "-o", folder_ / "out", "--workers", "2"};
  const Words command = Preload() + run + job_;
  const Outcome outcome = RunProgram(command.front(), Words(command.begin() + 1, command.end()));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
  EXPECT_THAT(outcome.output,
              HasSubstr(std::string("quarantined: ") + kDeadlyTask + "; the same command begins it anew\n"));
  EXPECT_THAT(outcome.output, HasSubstr(std::string("; its last words: ") + kWords));
  EXPECT_THAT(outcome.output, HasSubstr(std::string("    | ") + kWords));
}

// As the kernel does when memory runs out: the process that works alone, of which nobody hears a word.
TEST_F(DisturbedJob, WorkersThatAreKilledForTheirMemoryAreReplacedAtOnce) {
  const std::map<std::string, std::string> expected = Undisturbed();
  ASSERT_EQ(Depthfarm({"keygen", "-o", folder_ / "keys"}).exit_code, 0);
  Farm farm("tcp://127.0.0.1:*", folder_ / "keys");
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const int victim = farm.AddWorker({"--name", "victim"});
  farm.AddWorker({"--name", "other"});
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job, 20));
  const std::vector<pid_t> working = ChildrenOf(farm.worker(victim).pid(), "depthfarm-worker");
  ASSERT_THAT(working, SizeIs(1));
  ASSERT_EQ(::kill(working.front(), SIGKILL), 0);
  const std::optional<ProcessEnd> end = farm.worker(victim).WaitFor(kDeadline);
  ASSERT_TRUE(end.has_value());
  EXPECT_EQ(end->signal, SIGKILL);
  ExpectDone(farm, job, output, expected);
  const std::string logged = farm.CoordinatorLogged();
  EXPECT_THAT(logged, HasSubstr(" name=victim reason=\"the worker was killed by signal 9 (Killed)"));
  EXPECT_THAT(logged, Not(HasSubstr("lease_expired")));
}

}  // namespace
}  // namespace depthfarm::system_test
