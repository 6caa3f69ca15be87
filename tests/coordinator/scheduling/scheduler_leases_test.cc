// Leases that end, workers that leave or come back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLease{6000};

TEST(SchedulerLeases, ReissuesATaskWhenItsLeaseExpires) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId first = farm.JoinAndAsk();
  const TaskId task = farm.Running(first).task.spec.id;
  const WorkerId second = farm.Join();
  farm.At(first).running.clear();  // the grant was lost: heartbeats go on and do not name it
  farm.PassWithBeats(kLease);
  EXPECT_EQ(farm.CountNotes("lease_expired"), 1);
  farm.Finish(second);
  EXPECT_EQ(farm.Running(second).task.spec.id, task);
  EXPECT_EQ(farm.Running(second).attempt, 2);
}

TEST(SchedulerLeases, LeasesThatRunOutTogetherEndOnceWhereTheFirstFailsTheirJob) {
  FakeFarm farm({.max_attempts = 1});
  farm.Submit(MakePlannedJob({.views = 4}));
  const std::vector<WorkerId> workers{farm.JoinAndAsk(), farm.Join()};
  farm.Finish(workers[0]);  // Prepare
  farm.Ask(workers[1]);
  const LeaseId first = farm.At(workers[0]).running.begin()->first;
  const LeaseId second = farm.At(workers[1]).running.begin()->first;
  for (const WorkerId worker : workers) farm.At(worker).running.clear();  // heartbeats go on and do not name them
  farm.PassWithBeats(kLease);
  EXPECT_EQ(farm.CountNotes("job_failed"), 1);
  EXPECT_EQ(farm.CountNotes("lease_expired"), 1);
  EXPECT_EQ(farm.attempts_ended.at(first).outcome, AttemptOutcome::kExpired);
  EXPECT_EQ(farm.attempts_ended.at(second).outcome, AttemptOutcome::kRevoked);
}

TEST(SchedulerLeases, HeartbeatsKeepALeaseAlive) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.PassWithBeats(10 * kLease);
  EXPECT_EQ(farm.grants.size(), 1U);
  EXPECT_FALSE(farm.IsIdle(worker));
}

TEST(SchedulerLeases, IgnoresTheResultOfAnExpiredLeaseButRemembersItsArtifact) {
  FakeFarm farm;
  PlannedJob job = MakePlannedJob({.frames = 1});
  farm.Submit(job);
  const WorkerId first = farm.JoinAndAsk();
  farm.Finish(first);  // Prepare
  const Grant late = farm.Running(first);
  ASSERT_EQ(late.task.spec.id.kind, TaskKind::kAnalyse);
  farm.Pass(kLease);  // the worker was lost
  EXPECT_EQ(farm.scheduler.Workers().size(), 0U);
  farm.At(first).running.clear();
  farm.Rejoin(first);
  const std::uint64_t done_before = farm.scheduler.Job(JobId(1))->stages[1].tasks_done;
  farm.Send(farm.ResultOf(farm.At(first), late));
  EXPECT_EQ(farm.scheduler.late_results(), 1U);
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->stages[1].tasks_done, done_before);
  EXPECT_EQ(farm.scheduler.Workers()[0].artifacts, 1U);
}

TEST(SchedulerLeases, AResultCountsOnceHoweverOftenItComes) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  const Grant grant = farm.Running(worker);
  farm.At(worker).running.clear();
  const TaskFinished result = farm.ResultOf(farm.At(worker), grant);
  farm.Send(result);
  farm.Send(result);
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->stages[1].tasks_done, 1U);
  EXPECT_EQ(farm.scheduler.late_results(), 1U);
}

TEST(SchedulerLeases, ALostWorkersTasksBehindItsSlotsDidNotFail) {
  FakeFarm farm({.max_attempts = 1});
  farm.Submit(MakePlannedJob({.frames = 100, .gop = 1, .views = 2}));
  const WorkerId first = farm.JoinAndAsk(1, 2);
  ASSERT_GE(farm.At(first).running.size(), 2U);
  const TaskId behind = std::next(farm.At(first).running.begin())->second.task.spec.id;
  farm.Kill(first);
  farm.Pass(kLease);
  EXPECT_THAT(farm.scheduler.Job(JobId(1))->error.message(), testing::HasSubstr("failed 1 times"));
  EXPECT_THAT(farm.scheduler.Job(JobId(1))->error.message(), testing::Not(testing::HasSubstr(TaskName(behind))));
}

TEST(SchedulerLeases, ARevokedTaskCountsUntilTheWorkerSaysThatItIsOver) {
  for (const bool asks : {true, false}) {
    FakeFarm farm;
    farm.stops_late = true;
    farm.Submit(MakePlannedJob({.frames = 4, .gop = 1, .views = 2}));
    const WorkerId worker = farm.JoinAndAsk(2);
    farm.Finish(worker);  // Prepare was among them
    ASSERT_EQ(farm.At(worker).running.size(), 2U);
    farm.Cancel(1);
    const auto say = [&] { asks ? farm.Ask(worker) : farm.Beat(worker); };
    farm.JoinAndAsk();  // it would clean up
    say();
    EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 0);
    ASSERT_EQ(farm.At(worker).running.size(), 2U);
    farm.At(worker).running.erase(farm.At(worker).running.begin());  // older workers do not report it
    say();
    EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 0);
    farm.At(worker).running.clear();
    say();
    EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 1);
  }
}

// A worker with one slot whose grant and an ask and a heartbeat of before cross each other.
class CrossedGrant : public testing::Test {
 protected:
  CrossedGrant() {
    farm_.stops_late = true;
    farm_.Submit(MakePlannedJob({.frames = 4, .gop = 1, .views = 2}));
    worker_ = farm_.JoinAndAsk();
    farm_.Finish(worker_);  // Prepare; the grant of the next task is on its way
    farm_.Cancel(1);
    other_ = farm_.JoinAndAsk();
    farm_.Send(WorkerAsked{worker_, ++farm_.At(worker_).asks, {}});
    farm_.Send(WorkerHeard{worker_, ++farm_.At(worker_).beats, {}});
  }
  [[nodiscard]] int CleanupsGranted() const { return farm_.CountGrants(TaskKind::kCleanup, 0); }

  FakeFarm farm_;
  WorkerId worker_{0};
  WorkerId other_{0};
};

TEST_F(CrossedGrant, IsNotOverWhereTheyDoNotNameIt) {
  EXPECT_EQ(CleanupsGranted(), 0) << "the worker begins it yet, and may write into the folder";
}

TEST_F(CrossedGrant, IsOverWithItsReport) {
  farm_.Fail(worker_, Cancelled());
  EXPECT_EQ(CleanupsGranted(), 1);
  EXPECT_EQ(farm_.scheduler.late_results(), 0U);
}

TEST_F(CrossedGrant, IsOverWhenALaterMessageThanOneThatNamedItDoesNot) {
  farm_.Beat(worker_);
  farm_.At(worker_).running.clear();
  farm_.Ask(worker_);
  EXPECT_EQ(CleanupsGranted(), 0) << "whether the ask came after that heartbeat is not known";
  farm_.Send(WorkerHeard{worker_, farm_.At(worker_).beats - 1, {}});  // overtaken by it
  EXPECT_EQ(CleanupsGranted(), 0);
  farm_.Beat(worker_);
  EXPECT_EQ(CleanupsGranted(), 1);
}

TEST_F(CrossedGrant, IsOverAfterALeaseIfItNeverArrived) {
  farm_.At(worker_).running.clear();
  farm_.PassWithBeats(kLease - milliseconds(1));
  EXPECT_EQ(CleanupsGranted(), 0);
  farm_.PassWithBeats(milliseconds(1));
  EXPECT_EQ(CleanupsGranted(), 1);
}

TEST_F(CrossedGrant, IsNotOverWithAHelloThatNamesIt) {
  farm_.Rejoin(worker_);
  EXPECT_EQ(CleanupsGranted(), 0);
  EXPECT_EQ(farm_.revokes.back().lease, farm_.Running(worker_).lease) << "the worker may not have heard it";
  farm_.At(worker_).running.clear();
  farm_.Rejoin(worker_);
  farm_.Ask(worker_);
  EXPECT_EQ(CleanupsGranted(), 1);
}

TEST(SchedulerLeases, TheEndOfAStoppedTaskWhoseLeaseIsOverIsNoLateResult) {
  FakeFarm farm;
  const WorkerId worker = farm.Join();
  farm.Send(TaskFailed{worker, LeaseId(77), {}, Cancelled(), {}});
  EXPECT_EQ(farm.scheduler.late_results(), 0U);
  EXPECT_EQ(farm.CountNotes("late_result"), 0);
}

TEST(SchedulerLeases, ADrainedWorkerEndsAfterItsTasksAndGetsNoMore) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 50, .gop = 1}));
  const WorkerId first = farm.JoinAndAsk(1, 1);
  const WorkerId second = farm.JoinAndAsk();
  ASSERT_EQ(farm.At(first).running.size(), 2U);
  farm.Send(WorkerDrained{first});
  farm.Finish(first);
  EXPECT_TRUE(farm.told_to_end.empty());
  farm.Finish(first);
  EXPECT_TRUE(farm.IsIdle(first));
  EXPECT_EQ(farm.told_to_end, std::set<WorkerId>{first});
  farm.Leave(first);
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm.ended.at(JobId(1)).retries, 0U);
  EXPECT_FALSE(farm.told_to_end.contains(second));
}

TEST(SchedulerLeases, AnIdleWorkerThatIsDrainedEndsAtOnce) {
  FakeFarm farm;
  const WorkerId worker = farm.JoinAndAsk();
  farm.Send(WorkerDrained{worker});
  EXPECT_TRUE(farm.told_to_end.contains(worker));
  farm.Send(WorkerDrained{WorkerId(99)});  // nobody
}

TEST(SchedulerLeases, AWorkerThatSaysHelloAgainKeepsTheTaskItStillRuns) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.now += kLease - milliseconds(1);
  farm.Rejoin(worker);
  farm.Pass(kLease - milliseconds(1));
  farm.Finish(worker);
  EXPECT_EQ(farm.scheduler.late_results(), 0U);
}

TEST(SchedulerLeases, UnknownLeasesOfAHelloAreRevoked) {
  FakeFarm farm;
  const WorkerId worker = farm.Join();
  farm.Send(WorkerJoined{.worker = worker, .name = "w", .running = {LeaseId(77)}});
  ASSERT_EQ(farm.revokes.size(), 1U);
  EXPECT_EQ(farm.revokes[0].lease, LeaseId(77));
}

}  // namespace
}  // namespace depthfarm
