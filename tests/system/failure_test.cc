// Workers that die, jobs that are cancelled, runs that are interrupted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "common/base/machine_memory.h"
#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Failure = DisturbedJob;

// Killed after so many tasks of about 200 (6: while the first frames are analysed and cut; 40, 100: while they are
// refined), and in the middle of every way to split the levels.
struct Kill {
  int tasks;
  int blocks;
  const char* partition;
};
class KilledWorker : public Failure, public testing::WithParamInterface<Kill> {};
INSTANTIATE_TEST_SUITE_P(After, KilledWorker,
                         testing::Values(Kill{6, 4, "interleaved"}, Kill{40, 4, "interleaved"},
                                         Kill{100, 4, "interleaved"}, Kill{25, 1, "interleaved"},
                                         Kill{25, 2, "interleaved"}, Kill{25, 6, "interleaved"}, Kill{25, 1, "blocks"},
                                         Kill{25, 2, "blocks"}, Kill{25, 4, "blocks"}, Kill{25, 6, "blocks"}),
                         [](const testing::TestParamInfo<Kill>& kill) {
                           return std::to_string(kill.param.tasks) + "TasksOf" + kill.param.partition +
                                  std::to_string(kill.param.blocks);
                         });

TEST_P(KilledWorker, LeavesDepthByteIdentical) {
  job_ = LongerJob(GetParam().blocks, GetParam().partition);
  const auto expected = Undisturbed();
  ASSERT_THAT(expected, SizeIs(3 * 8 + 1));
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const int victim = farm.AddWorker();
  const std::string output = folder_ / "disturbed";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job_id, static_cast<std::uint64_t>(GetParam().tasks)));
  farm.worker(victim).Signal(SIGKILL);
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
  EXPECT_EQ(last.determinism_violations(), 0U);
  EXPECT_THAT(Differences(expected, DepthOf(output)), IsEmpty());
  EXPECT_THAT(Leftovers(output), IsEmpty());
}

TEST_F(Failure, WorkersOfSeveralSlotsGiveTheSameBytesAlsoIfOneIsKilled) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--slots", "3", "--ahead", "2"});
  const int victim = farm.AddWorker({"--slots", "2"});
  const std::string output = folder_ / "slots";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job_id, 25));
  farm.worker(victim).Signal(SIGKILL);
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
  EXPECT_EQ(last.determinism_violations(), 0U);
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output)), IsEmpty());
}

TEST_F(Failure, AWorkerThatComesLaterTakesOverFromTheOnlyOne) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const int first = farm.AddWorker();
  const std::string output = folder_ / "handed-over";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job_id, 6));
  farm.worker(first).Signal(SIGKILL);  // with all intermediate results
  farm.AddWorker();
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output)), IsEmpty());
}

TEST_F(Failure, CancelLeavesNoPartialFiles) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const std::string output = folder_ / "cancelled";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job_id, 6));
  const Outcome cancelled = Depthfarm(Words{"cancel", std::to_string(job_id)} + farm.Options());
  EXPECT_EQ(cancelled.exit_code, 0) << cancelled.output;
  EXPECT_EQ(WaitForTheEnd(farm, job_id).state(), v1::JOB_STATE_CANCELLED) << farm.Logs();
  EXPECT_TRUE(WaitUntil([&] { return Leftovers(output).empty(); }))
      << testing::PrintToString(Leftovers(output)) << farm.Logs();
  EXPECT_FALSE(fs::exists(fs::path(output) / "depth.json"));
}

// `depthfarm run` started in the background, with a temporary root of its own to see what it leaves.
class RunInBackground : public Failure {
 protected:
  void SetUp() override {
    Failure::SetUp();
    ::setenv("TMPDIR", temporary_root_.path().c_str(), 1);
    output_ = folder_ / "run";
    StartRun();
  }
  void TearDown() override { ::unsetenv("TMPDIR"); }

  void StartRun() {
    const Words words = Words{"run", sequence_, "-o", output_, "--workers", "2"} + Kept() + LongerJob();
    Result<ChildProcess> run = ChildProcess::Start(Program("depthfarm"), words, folder_ / "run.log");
    ASSERT_TRUE(run.ok()) << run.status().message();
    run_.emplace(std::move(*run));
  }

  Words Kept() { return {"--cache-dir", folder_ / "kept"}; }
  std::string Log() { return ReadFile(folder_ / "run.log"); }
  std::vector<pid_t> Workers() { return ChildrenOf(run_->pid(), "depthfarm-worker"); }

  // Waits for the first finished frame, when half of the work is still to do.
  void WaitForAFrame() {
    ASSERT_TRUE(WaitUntil([&] { return !DepthOf(output_).empty() || run_->Poll(); })) << Log();
    ASSERT_FALSE(run_->Poll()) << "ended before it could be disturbed\n" << Log();
    ASSERT_FALSE(Workers().empty());
  }

  bool AllGone(const std::vector<pid_t>& processes) {
    return WaitUntil([&] { return std::ranges::all_of(processes, IsGone); });
  }

  TemporaryFolder temporary_root_;
  std::string output_;
  std::optional<ChildProcess> run_;
};

TEST_F(RunInBackground, StartsAKilledWorkerAgain) {
  ASSERT_NO_FATAL_FAILURE(WaitForAFrame());
  ASSERT_EQ(::kill(Workers().front(), SIGKILL), 0);
  const std::optional<ProcessEnd> end = run_->WaitFor(kDeadline);
  ASSERT_TRUE(end.has_value()) << Log();
  EXPECT_TRUE(end->ok()) << Describe(*end) << "\n" << Log();
  const nlohmann::json record = nlohmann::json::parse(ReadFile(fs::path(output_) / "run.json"), nullptr, false);
  ASSERT_FALSE(record.is_discarded());
  EXPECT_EQ(record["respawns"], 1);
  EXPECT_EQ(record["state"], "done");
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output_)), IsEmpty());
  EXPECT_TRUE(fs::is_empty(temporary_root_.path()));
}

// What follows --task-memory on the command line of a process; 0 without it.
std::uint64_t TaskMemoryOf(pid_t worker) {
  std::string line = ReadFile("/proc/" + std::to_string(worker) + "/cmdline");
  const std::string option = std::string("--task-memory") + '\0';
  const std::size_t at = line.find(option);
  return at == std::string::npos ? 0 : std::stoull(line.substr(at + option.size()));
}

TEST_F(RunInBackground, ItsWorkersShareTheMemoryOfTheMachine) {
  ASSERT_TRUE(WaitUntil([&] { return Workers().size() == 2; })) << Log();
  for (const pid_t worker : Workers()) {
    EXPECT_GT(TaskMemoryOf(worker), 0U);
    EXPECT_LE(TaskMemoryOf(worker), MachineMemory() / 2);
  }
}

TEST_F(RunInBackground, CleansUpWhenInterrupted) {
  ASSERT_NO_FATAL_FAILURE(WaitForAFrame());
  const std::vector<pid_t> workers = Workers();
  run_->Signal(SIGINT);
  const std::optional<ProcessEnd> end = run_->WaitFor(kDeadline);
  ASSERT_TRUE(end.has_value()) << Log();
  EXPECT_EQ(end->exit_code, 130) << Log();
  EXPECT_TRUE(AllGone(workers));
  EXPECT_TRUE(fs::is_empty(temporary_root_.path()));
  EXPECT_THAT(Leftovers(output_), IsEmpty());
  EXPECT_FALSE(fs::exists(fs::path(output_) / "depth.json"));
}

TEST_F(RunInBackground, NoProcessOutlivesItWhenItIsKilled) {
  ASSERT_NO_FATAL_FAILURE(WaitForAFrame());
  std::vector<pid_t> processes = Workers();
  const std::vector<pid_t> coordinators = ChildrenOf(run_->pid(), "depthfarm-coordinator");
  ASSERT_THAT(coordinators, SizeIs(1));
  processes.push_back(coordinators.front());
  run_->Signal(SIGKILL);
  EXPECT_TRUE(AllGone(processes));
}

TEST_F(RunInBackground, ItsFolderIsFitForTheNextRunAfterAnInterruption) {
  ASSERT_NO_FATAL_FAILURE(WaitForAFrame());
  run_->Signal(SIGTERM);
  const std::optional<ProcessEnd> end = run_->WaitFor(kDeadline);
  ASSERT_TRUE(end.has_value()) << Log();
  EXPECT_EQ(end->exit_code, 130) << Log();
  const Outcome again = Depthfarm(Words{"run", sequence_, "-o", output_, "--workers", "2"} + LongerJob());
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output_)), IsEmpty());
}

TEST_F(RunInBackground, TheNextRunGoesOnWhereItWasInterruptedOrKilled) {
  for (const int signal : {SIGINT, SIGKILL}) {
    SCOPED_TRACE(signal);
    ASSERT_NO_FATAL_FAILURE(WaitForAFrame());
    const std::vector<pid_t> workers = Workers();
    run_->Signal(signal);
    ASSERT_TRUE(run_->WaitFor(kDeadline).has_value()) << Log();
    ASSERT_TRUE(AllGone(workers));
    if (signal == SIGINT) {
      EXPECT_THAT(Log(), HasSubstr("goes on from there"));
    }
    const Outcome again =
        Depthfarm(Words{"run", sequence_, "-o", output_, "--workers", "3", "--json"} + Kept() + LongerJob());
    ASSERT_EQ(again.exit_code, 0) << again.output;
    const Words difference = Differences(Undisturbed(), DepthOf(output_));
    EXPECT_THAT(difference, IsEmpty());
    std::size_t reused = 0;
    const nlohmann::json record = ParseJsonTail(again.output);
    for (const nlohmann::json& stage : record["stages"]) reused += stage.at("reused").get<std::size_t>();
    EXPECT_GT(reused, 0U) << again.output;
    fs::remove_all(folder_ / "kept");
    fs::remove_all(output_);
    if (signal == SIGINT) {
      ASSERT_NO_FATAL_FAILURE(StartRun());
    }
  }
}

}  // namespace
}  // namespace depthfarm::system_test
