// Tasks that fail, again and again, or take their workers with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using testing::SizeIs;

constexpr Milliseconds kLease{6000};

TEST(Failures, EachIsFollowedByALongerPause) {
  SchedulerOptions options;
  options.max_attempts = 5;
  options.longest_retry_pause = Milliseconds(1500);
  FakeFarm farm(options);
  farm.Submit(MakeRenderingJob(1, 1));  // nothing goes on before Prepare
  const WorkerId worker = farm.JoinAndAsk();
  for (const int pause : {500, 1000, 1500, 1500}) {
    ASSERT_EQ(farm.Running(worker).task.spec.id.kind, TaskKind::kPrepare);
    farm.Fail(worker, Unavailable("no space left on the device"));
    farm.Pass(Milliseconds(pause - 1));
    farm.Ask(worker);
    EXPECT_TRUE(farm.IsIdle(worker)) << pause;
    farm.Pass(Milliseconds(1));
    EXPECT_FALSE(farm.IsIdle(worker)) << pause;
  }
  farm.Fail(worker, Unavailable("no space left on the device"));
  EXPECT_EQ(farm.Running(worker).task.spec.id.kind, TaskKind::kCleanup) << "five attempts were all";
}

TEST(Failures, WhatRestsDoesNotHoldUpTheOthers) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = 3}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  const TaskId failed = farm.Running(worker).task.spec.id;
  farm.Fail(worker, Internal("it broke"));
  ASSERT_FALSE(farm.IsIdle(worker));
  EXPECT_NE(farm.Running(worker).task.spec.id, failed);
  EXPECT_EQ(farm.Running(worker).task.spec.id.kind, failed.kind);
}

TEST(Failures, ALostWorkerIsPauseEnough) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId first = farm.JoinAndAsk();
  farm.Kill(first);
  farm.Pass(kLease);
  const WorkerId second = farm.JoinAndAsk();
  EXPECT_EQ(farm.Running(second).task.spec.id.kind, TaskKind::kPrepare);
  EXPECT_EQ(farm.Running(second).attempt, 2);
}

// Whoever computes the first analysis of job 1 dies, and with it all that its worker has.
class Poison : public testing::Test {
 protected:
  static bool IsPoison(const Grant& grant) {
    return grant.task.spec.id == TaskId{JobId(1), 0, TaskKind::kAnalyse, 0, 0};
  }
  // And has begun it.
  static bool HasPoison(const FakeFarm& farm, const FakeWorker& worker) {
    return std::ranges::any_of(
        worker.running, [&](const auto& entry) { return IsPoison(entry.second) && farm.begun.contains(entry.first); });
  }
  // Until both jobs have ended; workers of four slots, one of which comes for each that dies.
  void Run(FakeFarm& farm) {
    for (int step = 0; step < 2000 && farm.ended.size() < 2; ++step) {
      std::vector<WorkerId> ids;
      for (const auto& [id, worker] : farm.workers) {
        if (worker.alive) ids.push_back(id);
      }
      for (const WorkerId id : ids) {
        if (HasPoison(farm, farm.At(id))) {
          ++deaths_;
          with_poison_.push_back(farm.At(id).running.size());
          farm.Kill(id);
          farm.JoinAndAsk(4, 1);
        } else if (!farm.IsIdle(id)) {
          farm.Finish(id);
        }
      }
      farm.PassWithBeats(kLease / 6);
    }
  }
  int deaths_ = 0;
  std::vector<std::size_t> with_poison_;  // tasks of each worker that died
};

TEST_F(Poison, FailsItsJobAfterItsAttemptsAndNoOther) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 4, .gop = 1, .views = 4}));
  farm.Submit(MakePlannedJob({.id = 2, .frames = 12, .gop = 1, .views = 4}));
  for (int i = 0; i < 3; ++i) farm.JoinAndAsk(4, 1);
  Run(farm);
  ASSERT_THAT(farm.ended, SizeIs(2));
  const JobSnapshot& poisonous = farm.ended.at(JobId(1));
  EXPECT_EQ(poisonous.state, JobState::kFailed);
  ASSERT_TRUE(poisonous.failed_task);
  EXPECT_EQ(*poisonous.failed_task, (TaskId{JobId(1), 0, TaskKind::kAnalyse, 0, 0}));
  EXPECT_EQ(deaths_, 4);
  EXPECT_EQ(farm.ended.at(JobId(2)).state, JobState::kDone) << farm.ended.at(JobId(2)).error.message();
}

TEST_F(Poison, IsTriedAloneOnceTwoWorkersAreLost) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 4, .gop = 1, .views = 4}));
  farm.Submit(MakePlannedJob({.id = 2, .frames = 12, .gop = 1, .views = 4}));
  for (int i = 0; i < 3; ++i) farm.JoinAndAsk(4, 1);
  Run(farm);
  ASSERT_THAT(with_poison_, SizeIs(4));
  EXPECT_GT(with_poison_[0], 1U);
  EXPECT_EQ(with_poison_[2], 1U);
  EXPECT_EQ(with_poison_[3], 1U);
}

TEST(Failures, AWorkerThatWasStartedAnewUnderItsNameHasDied) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 1, .views = 4}));
  const WorkerId worker = farm.JoinAndAsk(2, 1);
  farm.Finish(worker);
  ASSERT_THAT(farm.At(worker).running, SizeIs(3));
  const std::vector<LeaseId> leases = [&] {
    std::vector<LeaseId> ids;
    for (const auto& [lease, grant] : farm.At(worker).running) ids.push_back(lease);
    return ids;
  }();
  const TaskId first = farm.Running(worker).task.spec.id;
  farm.At(worker).running.clear();
  farm.Send(WorkerJoined{.worker = worker, .name = "w1", .slots = 2, .ahead = 1, .restarted = true});
  EXPECT_EQ(farm.attempts_ended.at(leases[0]).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_EQ(farm.attempts_ended.at(leases[1]).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_EQ(farm.attempts_ended.at(leases[2]).outcome, AttemptOutcome::kGivenBack) << "no slot had begun it";
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->retries, 2U);
  farm.Ask(worker);
  bool again = false;
  for (const auto& [lease, grant] : farm.At(worker).running) {
    if (grant.task.spec.id == first) again = grant.attempt == 2;
  }
  EXPECT_TRUE(again) << "its artifacts and room are those of the new process";
}

TEST(Failures, AWorkerWhoseDeathIsToldIsOutAtOnceAndWhatItsSlotsHadFailed) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 1, .views = 4}));
  const WorkerId worker = farm.JoinAndAsk(2, 1);
  farm.Finish(worker);
  std::vector<LeaseId> leases;
  for (const auto& [lease, grant] : farm.At(worker).running) leases.push_back(lease);
  ASSERT_THAT(leases, SizeIs(3));
  farm.Send(WorkerDied{worker, "was killed by signal 6 (Aborted)", {}});
  EXPECT_FALSE(farm.scheduler.Knows(worker));
  EXPECT_EQ(farm.attempts_ended.at(leases[0]).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_THAT(farm.attempts_ended.at(leases[0]).error.message(),
              testing::HasSubstr("the worker was killed by signal 6 (Aborted)"));
  EXPECT_EQ(farm.attempts_ended.at(leases[1]).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_EQ(farm.attempts_ended.at(leases[2]).outcome, AttemptOutcome::kGivenBack) << "no slot had begun it";
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->retries, 2U);
  farm.Send(WorkerDied{worker, "was killed again", {}});
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->retries, 2U);
}

TEST(Failures, WhatADeadWorkerWasComputingFailedAndNothingElse) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 1, .views = 4}));
  const WorkerId worker = farm.JoinAndAsk(2, 1);
  farm.Finish(worker);
  std::vector<LeaseId> leases;
  for (const auto& [lease, grant] : farm.At(worker).running) leases.push_back(lease);
  ASSERT_THAT(leases, SizeIs(3));
  // It had done the first and begun the last, which it could not tell any more.
  farm.Send(WorkerDied{worker, "was killed", {leases[1], leases[2], LeaseId(12345)}});
  EXPECT_EQ(farm.attempts_ended.at(leases[0]).outcome, AttemptOutcome::kGivenBack);
  EXPECT_EQ(farm.attempts_ended.at(leases[1]).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_EQ(farm.attempts_ended.at(leases[2]).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->retries, 2U);
}

TEST(Failures, OneThatSaysHelloAgainWithoutATaskNeverHadIt) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.At(worker).running.clear();
  farm.Rejoin(worker);
  farm.Ask(worker);
  EXPECT_EQ(farm.Running(worker).attempt, 1);
}

TEST(Failures, ANamedWorkerThatIsStartedAgainAtOnceDiesNoMoreOftenThanAttemptsAllow) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .gop = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  int deaths = 0;
  for (; deaths < 50 && !farm.IsIdle(worker) && farm.Running(worker).task.spec.id.kind == TaskKind::kPrepare;
       ++deaths) {
    farm.At(worker).running.clear();
    farm.Send(WorkerJoined{.worker = worker, .name = "w1", .restarted = true});
    farm.Ask(worker);
  }
  EXPECT_EQ(deaths, 4);
}

}  // namespace
}  // namespace depthfarm
