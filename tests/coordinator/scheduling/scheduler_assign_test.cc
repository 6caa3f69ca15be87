// Who gets which task.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "common/digest/sha256.h"
#include "coordinator/planning/cost_model.h"
#include "coordinator/scheduling/scheduler.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLease{6000};

// That a task of a job's first frame is expected to take beside the process.
std::uint64_t MemoryOf(const PlannedJob& job, TaskKind kind) {
  return CostModel(job.config.resolved).Of({JobId(1), 0, kind, 0, 0}).peak_memory_bytes - kProcessMemoryBytes;
}

TEST(Scheduler, AMergeGoesToTheWorkerThatHoldsItsInputs) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .views = 2, .blocks_i = 2}));
  const WorkerId first = farm.JoinAndAsk();
  RunUntil(farm, first, TaskKind::kEstimate);
  const WorkerId second = farm.JoinAndAsk();
  ASSERT_EQ(farm.Running(second).task.spec.id.kind, TaskKind::kEstimate);
  const WorkerId third = farm.JoinAndAsk();  // waits the longest, holds nothing
  EXPECT_TRUE(farm.IsIdle(third));
  farm.Finish(first);
  EXPECT_TRUE(farm.IsIdle(first));
  farm.Finish(second);
  EXPECT_TRUE(farm.IsIdle(third));
  EXPECT_EQ(farm.CountGrants(TaskKind::kMerge, 0), 1);
}

TEST(Scheduler, AStaleAskIsNotAnswered) {
  FakeFarm farm;
  const WorkerId worker = farm.JoinAndAsk();
  farm.now += kLease / 2;
  farm.Beat(worker);
  farm.Submit(MakePlannedJob({}));
  EXPECT_TRUE(farm.IsIdle(worker));
  farm.Ask(worker);
  EXPECT_FALSE(farm.IsIdle(worker));
}

TEST(Scheduler, ATaskThatBecomesReadyGoesToAWaitingWorker) {
  FakeFarm farm;
  const WorkerId worker = farm.JoinAndAsk();
  EXPECT_TRUE(farm.IsIdle(worker));
  farm.Submit(MakePlannedJob({}));
  EXPECT_EQ(farm.Running(worker).task.spec.id.kind, TaskKind::kPrepare);
}

TEST(Scheduler, AWorkerIsGivenATaskForEachOfItsSlots) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 2, .views = 3}));
  const WorkerId worker = farm.JoinAndAsk(3);
  EXPECT_EQ(farm.At(worker).running.size(), 3U);
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
}

TEST(Scheduler, TasksGoAheadWhileEnoughIsReadyForFreeSlots) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 100, .gop = 1, .views = 2}));
  const WorkerId first = farm.JoinAndAsk(1, 1);
  EXPECT_EQ(farm.At(first).running.size(), 2U);
}

TEST(Scheduler, TheLastReadyTasksWaitForAFreeSlot) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = 3, .blocks_i = 2}));
  const WorkerId worker = farm.JoinAndAsk(1, 2);
  RunUntil(farm, worker, TaskKind::kEstimate);
  EXPECT_EQ(farm.At(worker).running.size(), 1U);  // the other one is left for whoever is free first
}

TEST(Scheduler, ATaskAheadGoesToTheWorkerOnlyAfterAllFreeSlots) {
  FakeFarm farm;
  const WorkerId first = farm.JoinAndAsk(1, 1);
  const WorkerId second = farm.JoinAndAsk(1, 1);
  farm.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = 2, .blocks_i = 1}));
  EXPECT_EQ(farm.At(first).running.size(), 1U);
  EXPECT_EQ(farm.At(second).running.size(), 1U);
}

TEST(Scheduler, AJobWithTagsGoesToWorkersThatHaveThemAll) {
  FakeFarm farm;
  const WorkerId plain = farm.JoinAndAsk();
  farm.Submit(MakePlannedJob({}), 0, {"fast", "room2"});
  EXPECT_TRUE(farm.IsIdle(plain));
  EXPECT_TRUE(farm.scheduler.Job(JobId(1))->lacks_worker);
  const WorkerId tagged = farm.Join();
  farm.At(tagged).tags = {"fast", "large", "room2"};
  farm.Rejoin(tagged);
  farm.Ask(tagged);
  EXPECT_FALSE(farm.IsIdle(tagged));
  EXPECT_FALSE(farm.scheduler.Job(JobId(1))->lacks_worker);
  farm.Submit(MakePlannedJob({.id = 2}));  // takes either
  EXPECT_FALSE(farm.IsIdle(plain));
  farm.RunToTheEnd();
  for (const Grant& grant : farm.grants) {
    if (grant.task.spec.id.job == JobId(1)) {
      EXPECT_EQ(grant.worker, tagged);
    }
  }
}

TEST(Scheduler, TasksGoToWorkersOfTheJobsAlgorithmVersionAlone) {
  FakeFarm farm;
  const WorkerId newer = farm.Join(4);
  farm.At(newer).algorithm_version = kAlgorithmVersion + 1;
  farm.Rejoin(newer);
  farm.Ask(newer);
  farm.Submit(MakePlannedJob({}));
  EXPECT_TRUE(farm.IsIdle(newer));
  EXPECT_TRUE(farm.scheduler.Job(JobId(1))->lacks_worker);
  const WorkerId same = farm.JoinAndAsk();
  EXPECT_FALSE(farm.IsIdle(same));
  PlannedJob of_newer = MakePlannedJob({.id = 2});
  of_newer.config.algorithm_version = kAlgorithmVersion + 1;
  farm.Submit(of_newer);
  EXPECT_FALSE(farm.IsIdle(newer));
  farm.RunToTheEnd();
  for (const Grant& grant : farm.grants) EXPECT_EQ(grant.worker, grant.task.spec.id.job == JobId(1) ? same : newer);
}

TEST(Scheduler, AWorkerGetsNoMoreTasksThanItsMemoryHolds) {
  FakeFarm farm;
  const PlannedJob job = MakePlannedJob({.frames = 50, .gop = 1, .views = 4});
  const std::uint64_t need = MemoryOf(job, TaskKind::kAnalyse);
  ASSERT_GT(need, 0U);
  farm.Submit(job);
  const WorkerId first = farm.JoinAndAsk();
  farm.Finish(first);  // Prepare
  const WorkerId large = farm.Join(4);
  farm.At(large).memory_bytes = kProcessMemoryBytes + 3 * need;
  farm.Rejoin(large);
  farm.Ask(large);
  EXPECT_EQ(farm.At(large).running.size(), 3U);
}

TEST(Scheduler, AFailureOnTheOnlyWorkerThatTakesATaskDoesNotStopIt) {
  FakeFarm farm;
  farm.JoinAndAsk();
  const WorkerId tagged = farm.Join();
  farm.At(tagged).tags = {"fast"};
  farm.At(tagged).memory_bytes = 1;  // too small, but there is no larger one with the tag
  farm.Rejoin(tagged);
  farm.Ask(tagged);
  farm.Submit(MakePlannedJob({}), 0, {"fast"});
  farm.Fail(tagged, Internal("by chance"));
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm.ended.at(JobId(1)).retries, 1U);
}

TEST(Scheduler, AJobThatNobodyTakesDoesNotKeepOthersWaiting) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 20, .gop = 1, .views = 8}), 5, {"nowhere"});
  farm.Submit(MakePlannedJob({.id = 2, .frames = 20, .gop = 1}));
  farm.JoinAndAsk(2, 1);
  for (int step = 0; step < 10'000 && !farm.ended.contains(JobId(2)); ++step) {
    for (auto& [id, worker] : farm.workers) {
      if (!worker.running.empty()) farm.Finish(id);
    }
  }
  EXPECT_TRUE(farm.ended.contains(JobId(2)));
}

TEST(Scheduler, ALargeTaskIsNotPassedOverForever) {
  FakeFarm farm;
  const PlannedJob large = MakePlannedJob({.id = 1, .frames = 3, .gop = 1, .views = 8, .blocks_i = 1});
  const PlannedJob small = MakePlannedJob({.id = 2, .frames = 200, .gop = 1, .views = 1, .blocks_i = 1});
  const std::uint64_t most = MemoryOf(large, TaskKind::kEstimate);
  const WorkerId worker = farm.Join(4);
  farm.At(worker).memory_bytes = kProcessMemoryBytes + most + (most >> 3U);
  farm.Rejoin(worker);
  farm.Submit(small);
  farm.Submit(large, 3);
  farm.Ask(worker);
  int steps = 0;
  for (; steps < 200 && !farm.ended.contains(JobId(1)); ++steps) farm.Finish(worker);
  EXPECT_TRUE(farm.ended.contains(JobId(1)));
  EXPECT_LT(steps, 100);
}

TEST(Scheduler, ALargeTaskHoldsOneWorkerAndTheOthersGoOn) {
  FakeFarm farm;
  const PlannedJob large = MakePlannedJob({.id = 1, .frames = 1, .gop = 1, .views = 8, .blocks_i = 1});
  const PlannedJob small = MakePlannedJob({.id = 2, .frames = 400, .gop = 1, .views = 1, .blocks_i = 1});
  const std::uint64_t most = MemoryOf(large, TaskKind::kEstimate);
  farm.Submit(small);
  farm.Submit(large);
  std::vector<WorkerId> workers;
  for (int i = 0; i < 3; ++i) {
    workers.push_back(farm.Join(4));
    farm.At(workers.back()).memory_bytes = kProcessMemoryBytes + most + (most >> 3U);
    farm.Rejoin(workers.back());
    farm.Ask(workers.back());
  }
  // One worker after the other ends a task; heartbeats change who has waited longest.
  int most_idle = 0;
  for (int step = 0; step < 100 && !farm.ended.contains(JobId(1)); ++step) {
    const WorkerId worker = workers[static_cast<std::size_t>(step) % 3];
    if (!farm.IsIdle(worker)) farm.Finish(worker);
    farm.PassWithBeats(milliseconds(1000));
    int idle = 0;
    for (const WorkerId each : workers) idle += farm.IsIdle(each) ? 1 : 0;
    most_idle = std::max(most_idle, idle);
  }
  EXPECT_TRUE(farm.ended.contains(JobId(1)));
  EXPECT_LE(most_idle, 1);
}

TEST(Scheduler, AHeldWorkerStillTakesWhatIsOfHigherPriority) {
  FakeFarm farm;
  const PlannedJob large = MakePlannedJob({.id = 1, .frames = 1, .gop = 1, .views = 8, .blocks_i = 1});
  const std::uint64_t most = MemoryOf(large, TaskKind::kEstimate);
  const WorkerId worker = farm.Join(3);
  farm.At(worker).memory_bytes = kProcessMemoryBytes + most;  // alone
  farm.Rejoin(worker);
  farm.Submit(large);
  farm.Submit(MakePlannedJob({.id = 2, .frames = 400, .gop = 1, .views = 1, .blocks_i = 1}));
  farm.Ask(worker);
  const auto runs = [&](std::uint64_t job) {
    return std::ranges::any_of(farm.At(worker).running,
                               [&](const auto& entry) { return entry.second.task.spec.id.job == JobId(job); });
  };
  // Until only tasks of job 2 run beside the Estimate that waits.
  for (int step = 0; step < 50 && (runs(1) || farm.At(worker).running.size() == 3); ++step) farm.Finish(worker);
  ASSERT_FALSE(farm.IsIdle(worker));
  farm.Submit(MakePlannedJob({.id = 3, .frames = 1, .gop = 1, .views = 1, .blocks_i = 1}), 1);
  EXPECT_TRUE(runs(3));
}

TEST(Scheduler, ATaskThatIsTooLargeForAllRunsAlone) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 1, .views = 4}));
  const WorkerId worker = farm.Join(4);
  farm.At(worker).memory_bytes = 1;
  farm.Rejoin(worker);
  farm.Ask(worker);
  EXPECT_EQ(farm.At(worker).running.size(), 1U);
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
}

TEST(Scheduler, ASmallJobBehindHugeOnesStartsWithTheNextFreeWorker) {
  FakeFarm farm;
  for (std::uint64_t id = 1; id <= 5; ++id) farm.Submit(MakePlannedJob({.id = id, .frames = 1000, .gop = 1}));
  const std::vector<WorkerId> workers = {farm.JoinAndAsk(), farm.JoinAndAsk(), farm.JoinAndAsk()};
  for (int i = 0; i < 20; ++i) {
    for (const WorkerId worker : workers) farm.Finish(worker);
  }
  farm.Submit(MakePlannedJob({.id = 9, .frames = 1}));
  farm.Finish(workers[1]);
  EXPECT_EQ(farm.Running(workers[1]).task.spec.id.job, JobId(9));
}

TEST(Scheduler, JobsOfOnePriorityGoOnAtOnePace) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 50, .gop = 5, .views = 8}));
  farm.Submit(MakePlannedJob({.id = 2, .frames = 50, .gop = 5, .views = 8}));
  farm.Submit(MakePlannedJob({.id = 3, .frames = 50, .gop = 5, .views = 8}));
  const std::vector<WorkerId> workers = {farm.JoinAndAsk(), farm.JoinAndAsk(), farm.JoinAndAsk(), farm.JoinAndAsk()};
  for (int i = 0; i < 60; ++i) {
    for (const WorkerId worker : workers) farm.Finish(worker);
  }
  std::map<JobId, int> granted;
  for (const Grant& grant : farm.grants) ++granted[grant.task.spec.id.job];
  for (const auto& [job, count] : granted) EXPECT_NEAR(count, 80, 12) << job.value();
}

TEST(Scheduler, PriorityComesFirstThenSubmission) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1}), 0);
  farm.Submit(MakePlannedJob({.id = 2}), 0);
  farm.Submit(MakePlannedJob({.id = 3}), 5);
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  std::vector<std::uint64_t> order;
  for (const Grant& grant : farm.grants) {
    if (grant.task.spec.id.kind == TaskKind::kManifest) order.push_back(grant.task.spec.id.job.value());
  }
  EXPECT_THAT(order, testing::ElementsAre(3U, 1U, 2U));
}

TEST(Scheduler, WorkDoneForOneJobIsNotDoneAgainForAnother) {
  FakeFarm farm;
  const JobShape shape{.id = 1, .frames = 4, .gop = 2, .views = 2, .blocks_i = 2, .blocks_p = 2};
  farm.Submit(MakePlannedJob(shape));
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  const std::size_t before = farm.grants.size();
  JobShape longer = shape;
  longer.id = 2;
  longer.frames = 6;
  farm.Submit(MakePlannedJob(longer));
  farm.RunToTheEnd();
  const auto again = std::count_if(
      farm.grants.begin() + static_cast<std::ptrdiff_t>(before), farm.grants.end(), [](const Grant& grant) {
        const TaskId& id = grant.task.spec.id;
        return id.frame < 4 && (id.kind == TaskKind::kEstimate || id.kind == TaskKind::kMerge);
      });
  EXPECT_EQ(again, 0);
  EXPECT_EQ(farm.ended.at(JobId(2)).state, JobState::kDone);
  EXPECT_EQ(farm.ended.at(JobId(2)).stages[static_cast<std::size_t>(TaskKind::kEstimate)].reused, 8U);
}

TEST(Scheduler, AnAnalysisThatWasMadeBeforeGoesWhereItIsHeldAndIsNamed) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 1, .gop = 1, .views = 1}));
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  const WorkerId stranger = farm.Join();
  const WorkerId holder = farm.workers.begin()->first;
  farm.Submit(MakePlannedJob({.id = 2, .frames = 1, .gop = 1, .views = 1}));
  farm.Finish(holder);  // Prepare
  const Grant analyse = farm.Running(holder);
  ASSERT_EQ(analyse.task.spec.id.kind, TaskKind::kAnalyse);
  ASSERT_TRUE(analyse.task.spec.known.has_value());
  EXPECT_EQ(analyse.task.spec.known->artifact.key, Sha256("/in/cam0/0.png"));
  EXPECT_THAT(analyse.task.holders_of_known, testing::ElementsAre(holder));
  EXPECT_TRUE(farm.IsIdle(stranger));
  farm.RunToTheEnd();
}

TEST(Scheduler, AnAnalysisThatNobodyHoldsAnyMoreIsNotNamed) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 1, .gop = 1, .views = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.RunToTheEnd();
  farm.Drop(worker, Sha256("/in/cam0/0.png"));
  farm.Submit(MakePlannedJob({.id = 2, .frames = 1, .gop = 1, .views = 1}));
  EXPECT_FALSE(RunUntil(farm, worker, TaskKind::kAnalyse).task.spec.known.has_value());
}

TEST(Scheduler, WhatOneJobMakesNowIsNotMadeByAnother) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 6, .gop = 3, .views = 3, .blocks_i = 2}));
  farm.Submit(MakePlannedJob({.id = 2, .frames = 6, .gop = 3, .views = 3, .blocks_i = 2}));
  for (int i = 0; i < 5; ++i) farm.JoinAndAsk();
  farm.RunToTheEnd();
  std::map<ArtifactKey, int> made;
  for (const Grant& grant : farm.grants) {
    if (grant.task.spec.output_key) ++made[*grant.task.spec.output_key];
  }
  for (const auto& [key, count] : made) EXPECT_EQ(count, 1);
  for (const auto& [id, job] : farm.ended) EXPECT_EQ(job.state, JobState::kDone);
}

TEST(Scheduler, WorkersHaveAGopEachAndMoveNothing) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 12, .gop = 4, .views = 3, .refine = 2}));
  const WorkerId first = farm.JoinAndAsk();
  farm.Finish(first);  // Prepare
  farm.JoinAndAsk();
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  std::map<int, std::set<WorkerId>> workers_of;
  for (const Grant& grant : farm.grants) {
    const TaskId& id = grant.task.spec.id;
    if (!EndsAFrameOrJob(id.kind)) workers_of[id.frame / 4].insert(grant.worker);
  }
  ASSERT_EQ(workers_of.size(), 3U);
  for (const auto& [gop, workers] : workers_of) EXPECT_EQ(workers.size(), 1U) << gop;
}

TEST(Scheduler, AWorkerWithoutAGopHelpsWithTheMostUrgentOne) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 8, .gop = 4, .views = 3, .refine = 2}));
  const WorkerId first = farm.JoinAndAsk();
  farm.Finish(first);  // Prepare
  const WorkerId second = farm.JoinAndAsk();
  EXPECT_EQ(farm.Running(first).task.spec.id.frame, 0);
  EXPECT_EQ(farm.Running(second).task.spec.id.frame, 4);
  EXPECT_EQ(farm.Running(farm.JoinAndAsk()).task.spec.id.frame, 0);
}

TEST(Scheduler, AWorkerThatHasAGopIsGivenNothingAheadOfOthers) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 4, .gop = 2, .views = 8, .refine = 1}));
  const WorkerId first = farm.JoinAndAsk(1, 1);
  farm.Finish(first);     // Prepare
  farm.JoinAndAsk(1, 1);  // has the other GOP, and is slow
  while (farm.CountGrants(TaskKind::kEstimate, 1) == 0) {
    for (const auto& [lease, grant] : farm.At(first).running) EXPECT_LT(grant.task.spec.id.frame, 2);
    farm.Finish(first);
  }
  // What else is ready is of the other GOP. With nothing to do the worker helps.
  ASSERT_EQ(farm.At(first).running.size(), 1U);
  const WorkerId third = farm.JoinAndAsk(1, 1);
  EXPECT_EQ(farm.At(third).running.size(), 2U) << "which has no GOP";
}

// A worker of a job of one GOP until its last frame is refined, and one that joins then.
class LateHelper : public testing::Test {
 protected:
  void RunWith(std::uint64_t artifact_bytes) {
    farm_.artifact_bytes = artifact_bytes;
    farm_.Submit(MakePlannedJob({.frames = 3, .gop = 3, .views = 4, .refine = 2}));
    home_ = farm_.JoinAndAsk();
    while (farm_.CountGrants(TaskKind::kRefine, 2) == 0) farm_.Finish(home_);
    helper_ = farm_.JoinAndAsk();
  }
  FakeFarm farm_;
  WorkerId home_{};
  WorkerId helper_{};
};

TEST_F(LateHelper, HelpsWhereItReadsLittle) {
  RunWith(100);
  EXPECT_FALSE(farm_.IsIdle(helper_));
}

TEST_F(LateHelper, IsSparedWhatItWouldReadLongerThanItsHelpIsWorth) {
  RunWith(std::uint64_t{1} << 30);
  EXPECT_TRUE(farm_.IsIdle(helper_));
  farm_.RunToTheEnd();
  EXPECT_EQ(farm_.ended.at(JobId(1)).state, JobState::kDone);
}

TEST_F(LateHelper, GoesOnWhereTheHomeIsLost) {
  RunWith(std::uint64_t{1} << 30);
  farm_.Leave(home_);
  EXPECT_FALSE(farm_.IsIdle(helper_));
  farm_.RunToTheEnd();
  EXPECT_EQ(farm_.ended.at(JobId(1)).state, JobState::kDone);
}

TEST_F(LateHelper, GoesOnWhereTheHomeHasOtherWork) {
  RunWith(std::uint64_t{1} << 30);
  farm_.Submit(MakePlannedJob({.id = 2, .frames = 1, .gop = 1, .views = 3}), 1);
  const auto job_of = [&](WorkerId worker) {
    return farm_.IsIdle(worker) ? JobId() : farm_.Running(worker).task.spec.id.job;
  };
  bool helped = false;
  while (!helped && (!farm_.IsIdle(home_) || !farm_.IsIdle(helper_))) {
    if (!farm_.IsIdle(home_)) farm_.Finish(home_);
    helped = job_of(home_) == JobId(2) && job_of(helper_) == JobId(1);
    if (!helped && !farm_.IsIdle(helper_)) farm_.Finish(helper_);
    helped = helped || (job_of(home_) == JobId(2) && job_of(helper_) == JobId(1));
  }
  EXPECT_TRUE(helped);
  farm_.RunToTheEnd();
  for (const auto& [id, job] : farm_.ended) EXPECT_EQ(job.state, JobState::kDone);
}

TEST(Scheduler, AGopWhoseWorkerIsLostFindsAnotherHome) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 12, .gop = 4, .views = 3, .refine = 2}));
  const WorkerId first = farm.JoinAndAsk();
  farm.Finish(first);  // Prepare
  const WorkerId second = farm.JoinAndAsk();
  const WorkerId third = farm.JoinAndAsk();
  farm.Finish(second);
  farm.Leave(second);
  const WorkerId fourth = farm.JoinAndAsk();
  EXPECT_EQ(farm.Running(fourth).task.spec.id.frame, 4);
  for (int i = 0; i < 5; ++i) {
    farm.Finish(first);
    farm.Finish(third);
    farm.Finish(fourth);
    EXPECT_EQ(farm.Running(fourth).task.spec.id.frame / 4, 1);
  }
}

}  // namespace
}  // namespace depthfarm
