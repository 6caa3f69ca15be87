#include "coordinator/scheduling/scheduler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/digest/sha256.h"
#include "coordinator/planning/cost_model.h"
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

// Runs tasks on one worker until it is given one of the kind.
const Grant& RunUntil(FakeFarm& farm, WorkerId worker, TaskKind kind) {
  for (int i = 0; i < 1000 && farm.Running(worker).task.spec.id.kind != kind; ++i) farm.Finish(worker);
  EXPECT_EQ(farm.Running(worker).task.spec.id.kind, kind);
  return farm.Running(worker);
}

TEST(Scheduler, OneWorkerBringsAJobToItsEnd) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 5, .gop = 2, .views = 3, .blocks_i = 3, .blocks_p = 2}));
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  const JobSnapshot& job = farm.ended.at(JobId(1));
  EXPECT_EQ(job.state, JobState::kDone);
  EXPECT_EQ(job.frames_done, 5);
  for (int kind = 0; kind < kNumTaskKinds; ++kind) {
    const StageSnapshot& stage = job.stages[static_cast<std::size_t>(kind)];
    EXPECT_EQ(stage.tasks_done, stage.tasks_total) << kind;
    EXPECT_EQ(stage.cpu_seconds, static_cast<double>(stage.tasks_done)) << kind;
  }
  EXPECT_EQ(job.stages[static_cast<std::size_t>(TaskKind::kMerge)].tasks_done, 3U * 2 + 2 * 1);
  EXPECT_EQ(job.retries, 0U);
  EXPECT_EQ(job.determinism_violations, 0U);
}

TEST(Scheduler, GrantsCarryInputsInOrderWithHolders) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 2, .views = 2, .blocks_i = 2}));
  const WorkerId worker = farm.JoinAndAsk();
  const Grant merge = RunUntil(farm, worker, TaskKind::kMerge);
  ASSERT_EQ(merge.task.spec.inputs.size(), 4U);
  EXPECT_EQ(merge.task.spec.inputs[0].artifact.key, Sha256("/in/cam0/0.png"));
  EXPECT_EQ(merge.task.spec.inputs[1].artifact.key, Sha256("/in/cam1/0.png"));
  EXPECT_EQ(merge.task.spec.inputs[3].role, InputRole::kLabels);
  for (const auto& holders : merge.task.holders) EXPECT_THAT(holders, testing::ElementsAre(worker));
  EXPECT_TRUE(merge.task.spec.output_key.has_value());
}

TEST(Scheduler, TheManifestNamesEveryFileAndPictureByFrameThenView) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 3, .gop = 1, .views = 2}));
  const WorkerId worker = farm.JoinAndAsk();
  const Grant manifest = RunUntil(farm, worker, TaskKind::kManifest);
  ASSERT_EQ(manifest.task.spec.files.size(), 6U);
  EXPECT_EQ(manifest.task.spec.files[3].path, "depth/cam1/0001.png");
  ASSERT_EQ(manifest.task.spec.picture_digests.size(), 6U);
  EXPECT_EQ(manifest.task.spec.picture_digests[3], Sha256("picture /in/cam1/1.png"));
}

TEST(Scheduler, TheJobConfigGoesWithTheFirstTaskOnly) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  EXPECT_TRUE(farm.Running(worker).first_of_job);
  farm.Finish(worker);
  EXPECT_FALSE(farm.Running(worker).first_of_job);
  farm.Rejoin(worker);
  farm.Finish(worker);
  EXPECT_TRUE(farm.Running(worker).first_of_job);  // it may have been restarted
}

TEST(Scheduler, ReissuesATaskWhenItsLeaseExpires) {
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

TEST(Scheduler, HeartbeatsKeepALeaseAlive) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.PassWithBeats(10 * kLease);
  EXPECT_EQ(farm.grants.size(), 1U);
  EXPECT_FALSE(farm.IsIdle(worker));
}

TEST(Scheduler, IgnoresTheResultOfAnExpiredLeaseButRemembersItsArtifact) {
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

TEST(Scheduler, AResultCountsOnceHoweverOftenItComes) {
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

TEST(Scheduler, TwoContentsUnderOneKeyAreAViolation) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  const Grant grant = farm.Running(worker);
  farm.Finish(worker);
  TaskFinished other = farm.ResultOf(farm.At(worker), grant);
  other.artifact->content_digest[0] ^= 1;
  farm.Send(other);
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->determinism_violations, 1U);
  EXPECT_EQ(farm.CountNotes("determinism_violation"), 1);
}

TEST(Scheduler, ARerunThatMakesOtherBytesIsAViolation) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  const TaskId task = farm.Running(worker).task.spec.id;
  farm.Finish(worker);
  farm.Drop(worker, Sha256(std::string("/in/cam") + std::to_string(task.index) + "/0.png"));
  while (farm.Running(worker).task.spec.id != task) farm.Finish(worker);
  TaskFinished other = farm.ResultOf(farm.At(worker), farm.Running(worker));
  other.artifact->content_digest[0] ^= 1;
  farm.At(worker).running.clear();
  farm.Send(other);
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->determinism_violations, 1U);
}

TEST(Scheduler, ALostWorkersNeededArtifactsAreMadeAgainAndNoOthers) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 2, .views = 2, .blocks_i = 1, .blocks_p = 1}));
  const WorkerId first = farm.JoinAndAsk();
  // Frame 0 is committed: its labels and analyses are needed by Estimate of frame 1 alone.
  while (farm.CountGrants(TaskKind::kEstimate, 1) == 0) farm.Finish(first);
  const int analyses = farm.CountGrants(TaskKind::kAnalyse, 0) + farm.CountGrants(TaskKind::kAnalyse, 1);
  const int commits = farm.CountGrants(TaskKind::kCommit, 0);
  EXPECT_EQ(analyses, 4);
  farm.Kill(first);
  farm.Pass(kLease);
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 0), 4);  // made again
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 1), 4);
  EXPECT_EQ(farm.CountGrants(TaskKind::kEstimate, 0), 2);  // lineage of the labels
  EXPECT_EQ(farm.CountGrants(TaskKind::kCommit, 0), commits);
  EXPECT_EQ(farm.CountGrants(TaskKind::kEmit, 0), 1);
}

TEST(Scheduler, NothingIsMadeAgainThatAnotherWorkerHolds) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .views = 2, .blocks_i = 1}));
  const WorkerId first = farm.JoinAndAsk();
  const Grant estimate = RunUntil(farm, first, TaskKind::kEstimate);
  const WorkerId second = farm.Join();
  for (const TaskInput& input : estimate.task.spec.inputs) farm.At(second).store[input.artifact.key] = input.artifact;
  farm.Rejoin(second);
  farm.Kill(first);
  farm.now += kLease - milliseconds(1);
  farm.Ask(second);
  farm.Pass(milliseconds(1));
  EXPECT_EQ(farm.Running(second).task.spec.id, estimate.task.spec.id);
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 0), 2);
}

TEST(Scheduler, InputsThatCouldBeFetchedNowhereAreMadeAgain) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .views = 2, .blocks_i = 1}));
  const WorkerId first = farm.JoinAndAsk();
  RunUntil(farm, first, TaskKind::kEstimate);
  farm.At(first).store.clear();  // without a word
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 0), 4);
  EXPECT_EQ(farm.CountGrants(TaskKind::kEstimate, 0), 2);
}

TEST(Scheduler, AStoreThatNeverKeepsItsArtifactsFailsTheJobInTheEnd) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1, .views = 2, .blocks_i = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  for (int i = 0; i < 1000 && !farm.scheduler.Jobs().empty(); ++i) {
    if (farm.IsIdle(worker)) {
      farm.PassWithBeats(milliseconds(1000));
      continue;
    }
    farm.Finish(worker);
    const auto store = farm.At(worker).store;
    for (const auto& [key, artifact] : store) farm.Drop(worker, key);
  }
  ASSERT_TRUE(farm.ended.contains(JobId(1)));
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kFailed);
  EXPECT_NE(farm.ended.at(JobId(1)).error.message().find("lost more than"), std::string::npos);
}

TEST(Scheduler, AttemptsAreBoundedAndTheReasonIsKeptAndTheFolderCleanedUp) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  const TaskId task = farm.Running(worker).task.spec.id;
  int failures = 0;
  while (farm.Running(worker).task.spec.id.kind != TaskKind::kCleanup) {
    if (farm.Running(worker).task.spec.id == task) {
      EXPECT_EQ(farm.Running(worker).attempt, ++failures);
      farm.Fail(worker, Internal("it broke"));
    } else {
      farm.Finish(worker);
    }
  }
  EXPECT_EQ(failures, 4);
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->state, JobState::kRunning);
  EXPECT_NE(farm.scheduler.Job(JobId(1))->error.message().find("it broke"), std::string::npos);
  farm.Finish(worker);
  const JobSnapshot& job = farm.ended.at(JobId(1));
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.error.code(), ErrorCode::kInternal);
  EXPECT_EQ(job.error.message(), TaskName(task) + " failed 4 times, the last time: it broke");
  EXPECT_EQ(job.retries, 4U);
}

TEST(Scheduler, AFailedTaskGoesToAnotherWorkerIfThereIsOne) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId first = farm.JoinAndAsk();
  farm.Join();
  farm.Fail(first, Internal("it broke"));
  EXPECT_NE(farm.Running(first).task.spec.id.kind, TaskKind::kPrepare);
}

TEST(Scheduler, ATaskThatKillsWorkersFailsItsJobNotTheFarm) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1}));
  for (int i = 0; i < 4; ++i) {
    const WorkerId worker = farm.JoinAndAsk();
    EXPECT_EQ(farm.Running(worker).task.spec.id.kind, TaskKind::kPrepare);
    farm.Kill(worker);
    farm.Pass(kLease);
  }
  farm.Submit(MakePlannedJob({.id = 2}));
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kFailed);
  EXPECT_EQ(farm.ended.at(JobId(2)).state, JobState::kDone);
}

TEST(Scheduler, AnInvalidArgumentFailsTheJobAtOnce) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  farm.Fail(worker, InvalidArgument("picture /in/cam0/0.png is missing"));
  EXPECT_EQ(farm.Running(worker).task.spec.id.kind, TaskKind::kCleanup);
  farm.Finish(worker);
  EXPECT_EQ(farm.ended.at(JobId(1)).error.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(farm.ended.at(JobId(1)).retries, 0U);
}

TEST(Scheduler, AWorkerThatGivesBackATaskCostsNoAttempt) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  for (int i = 0; i < 10; ++i) farm.Fail(worker, {ErrorCode::kLeaseExpired, "asked too long ago"});
  EXPECT_EQ(farm.Running(worker).attempt, 1);
  farm.Leave(worker);
  EXPECT_EQ(farm.Running(farm.JoinAndAsk()).attempt, 1);
}

TEST(Scheduler, CancelRevokesLeasesAndCleansUpWhenTheyHaveEnded) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId first = farm.JoinAndAsk();
  farm.Finish(first);
  const WorkerId second = farm.Join();
  const LeaseId lease = farm.Running(first).lease;
  farm.Cancel(1);
  ASSERT_EQ(farm.revokes.size(), 1U);
  EXPECT_EQ(farm.revokes[0].lease, lease);
  farm.Ask(second);
  EXPECT_TRUE(farm.IsIdle(second)) << "the first worker may still write";
  farm.Ask(first);  // its slot is free
  EXPECT_EQ(farm.CountGrants(TaskKind::kCleanup, 0), 1);
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kCancelled);
  EXPECT_EQ(farm.ended.at(JobId(1)).error.code(), ErrorCode::kCancelled);
}

TEST(Scheduler, AJobCancelledBeforePrepareEndsAtOnce) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  farm.Cancel(1);
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kCancelled);
  EXPECT_TRUE(farm.scheduler.empty());
}

TEST(Scheduler, ACancelledJobEndsWithoutWorkersToCleanUp) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  farm.Kill(worker);
  farm.Cancel(1);
  farm.Pass(kLease);
  EXPECT_FALSE(farm.ended.contains(JobId(1)));
  farm.Pass(SchedulerOptions().cleanup_grace);
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kCancelled);
  EXPECT_TRUE(farm.scheduler.empty());
}

TEST(Scheduler, ArtifactsAreReleasedWhenTheirFrameOrGopIsDone) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 3, .gop = 3, .views = 2, .blocks_i = 1, .blocks_p = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  const auto released = [&](const std::string& picture) {
    return std::any_of(farm.releases.begin(), farm.releases.end(), [&](const Release& release) {
      return std::find(release.keys.begin(), release.keys.end(), Sha256(picture)) != release.keys.end();
    });
  };
  while (farm.CountGrants(TaskKind::kEmit, 2) == 0) farm.Finish(worker);
  EXPECT_TRUE(released("/in/cam0/1.png"));   // Estimate of frame 2 is done
  EXPECT_TRUE(released("/in/cam0/0.png"));   // and with it the last reader of the I frame
  EXPECT_FALSE(released("/in/cam0/2.png"));  // Emit of frame 2 reads it
  farm.RunToTheEnd();
  EXPECT_TRUE(released("/in/cam0/2.png"));
}

TEST(Scheduler, TheIFrameIsKeptUntilTheLastPFrameHasReadIt) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 3, .gop = 3, .views = 2, .blocks_i = 1, .blocks_p = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  while (farm.CountGrants(TaskKind::kEstimate, 2) == 0) farm.Finish(worker);
  for (const Release& release : farm.releases) {
    EXPECT_EQ(std::count(release.keys.begin(), release.keys.end(), Sha256("/in/cam0/0.png")), 0);
  }
}

TEST(Scheduler, OpensGopsOnlyAsWorkersNeedThem) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 1000, .gop = 1, .views = 2}));
  const auto ready_pictures = [&] { return farm.CountGrants(TaskKind::kAnalyse, 999); };
  farm.JoinAndAsk();
  EXPECT_EQ(ready_pictures(), 0);
  // Two tasks per worker are wanted; a GOP has two that are ready at once, Prepare is one: frames beyond the third are
  // not touched, whoever asks.
  for (int i = 0; i < 3; ++i) farm.JoinAndAsk();
  for (const Grant& grant : farm.grants) EXPECT_LT(grant.task.spec.id.frame, 4);
}

TEST(Scheduler, OpenGopsOfAJobAreBounded) {
  SchedulerOptions options;
  options.max_open_gops = 2;
  FakeFarm farm(options);
  farm.Submit(MakePlannedJob({.frames = 10, .gop = 1, .views = 2, .blocks_i = 1}));
  int farthest = 0;
  for (int i = 0; i < 20; ++i) farm.JoinAndAsk();
  for (const Grant& grant : farm.grants) farthest = std::max(farthest, grant.task.spec.id.frame);
  EXPECT_EQ(farthest, 1);
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
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

TEST(Scheduler, ALostWorkersTasksBehindItsSlotsDidNotFail) {
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

TEST(Scheduler, ARevokedTaskCountsUntilTheWorkerSaysThatItIsOver) {
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

TEST(Scheduler, ADrainedWorkerEndsAfterItsTasksAndGetsNoMore) {
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

TEST(Scheduler, AnIdleWorkerThatIsDrainedEndsAtOnce) {
  FakeFarm farm;
  const WorkerId worker = farm.JoinAndAsk();
  farm.Send(WorkerDrained{worker});
  EXPECT_TRUE(farm.told_to_end.contains(worker));
  farm.Send(WorkerDrained{WorkerId(99)});  // nobody
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

TEST(Scheduler, AWorkerThatSaysHelloAgainKeepsTheTaskItStillRuns) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.now += kLease - milliseconds(1);
  farm.Rejoin(worker);
  farm.Pass(kLease - milliseconds(1));
  farm.Finish(worker);
  EXPECT_EQ(farm.scheduler.late_results(), 0U);
}

TEST(Scheduler, UnknownLeasesOfAHelloAreRevoked) {
  FakeFarm farm;
  const WorkerId worker = farm.Join();
  farm.Send(WorkerJoined{worker, "w", {}, {LeaseId(77)}});
  ASSERT_EQ(farm.revokes.size(), 1U);
  EXPECT_EQ(farm.revokes[0].lease, LeaseId(77));
}

TEST(Scheduler, AnEmitThatNamesOtherFilesIsAFailedAttempt) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  const Grant emit = RunUntil(farm, worker, TaskKind::kEmit);
  TaskFinished result = farm.ResultOf(farm.At(worker), emit);
  result.files[0].path = "depth/cam0/0099.png";
  farm.At(worker).running.clear();
  farm.Send(result);
  farm.Ask(worker);
  EXPECT_EQ(farm.Running(worker).task.spec.id, emit.task.spec.id);
  EXPECT_EQ(farm.Running(worker).attempt, 2);
  EXPECT_NE(farm.Running(worker).task.spec.staging, emit.task.spec.staging);
}

TEST(Scheduler, AFolderIsSomeJobsWhileThatJobLives) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 4}));
  EXPECT_EQ(farm.scheduler.JobWritingTo("/out/4"), JobId(4));
  EXPECT_EQ(farm.scheduler.JobWritingTo("/out/5"), std::nullopt);
}

TEST(Scheduler, ASecondTickAtTheSameTimeDoesNothing) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  farm.JoinAndAsk();
  farm.now += kLease;
  EXPECT_FALSE(farm.scheduler.Tick(farm.now).empty());
  EXPECT_TRUE(farm.scheduler.Tick(farm.now).empty());
}

}  // namespace
}  // namespace depthfarm
