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
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 4, .gop = 1, .views = 2}));
  const WorkerId worker = farm.JoinAndAsk(2);
  farm.Finish(worker);  // Prepare was among them
  const std::map<LeaseId, Grant> running = farm.At(worker).running;
  ASSERT_EQ(running.size(), 2U);
  farm.Cancel(1);
  farm.At(worker).running = running;  // it has heard of it, but its tasks are not over
  farm.Ask(worker);
  EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 0);
  farm.At(worker).running.erase(farm.At(worker).running.begin());
  farm.Ask(worker);
  EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 0);
  farm.At(worker).running.clear();
  farm.Ask(worker);
  EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 1);
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
