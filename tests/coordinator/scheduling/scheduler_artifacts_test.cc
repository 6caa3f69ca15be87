// What is made again, what is kept for whom, and what must not differ.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/digest/sha256.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLease{6000};

TEST(SchedulerArtifacts, TwoContentsUnderOneKeyAreAViolation) {
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

TEST(SchedulerArtifacts, ARerunThatMakesOtherBytesIsAViolation) {
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

TEST(SchedulerArtifacts, ALostWorkersNeededArtifactsAreMadeAgainAndNoOthers) {
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

TEST(SchedulerArtifacts, NothingIsMadeAgainThatAnotherWorkerHolds) {
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

TEST(SchedulerArtifacts, InputsThatCouldBeFetchedNowhereAreMadeAgain) {
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

TEST(SchedulerArtifacts, AStoreThatNeverKeepsItsArtifactsFailsTheJobInTheEnd) {
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

TEST(SchedulerArtifacts, ArtifactsAreReleasedWhenTheirFrameOrGopIsDone) {
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

TEST(SchedulerArtifacts, TheIFrameIsKeptUntilTheLastPFrameHasReadIt) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 3, .gop = 3, .views = 2, .blocks_i = 1, .blocks_p = 1}));
  const WorkerId worker = farm.JoinAndAsk();
  while (farm.CountGrants(TaskKind::kEstimate, 2) == 0) farm.Finish(worker);
  for (const Release& release : farm.releases) {
    EXPECT_EQ(std::count(release.keys.begin(), release.keys.end(), Sha256("/in/cam0/0.png")), 0);
  }
}

TEST(SchedulerArtifacts, ASharedIFrameIsKeptUntilTheLastGopHasReadIt) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 12, .gop = 2, .views = 2, .refine = 1, .anchor = Anchor::kShared}));
  const WorkerId worker = farm.JoinAndAsk();
  const ArtifactKey of_i_frame = Sha256("/in/cam0/0.png");
  while (farm.ended.empty()) {
    const TaskId id = farm.Running(worker).task.spec.id;
    const auto released = [&](const Release& release) {
      return std::ranges::find(release.keys, of_i_frame) != release.keys.end();
    };
    if (id.kind != TaskKind::kManifest && id.frame < 10) {
      EXPECT_TRUE(std::ranges::none_of(farm.releases, released)) << TaskName(id);
    }
    farm.Finish(worker);
  }
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_TRUE(farm.scheduler.Jobs().empty());
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 0), 2);
}

TEST(SchedulerArtifacts, ASharedIFrameThatIsLostIsMadeAgainForALaterGop) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 12, .gop = 2, .views = 2, .refine = 1, .anchor = Anchor::kShared}));
  const WorkerId first = farm.JoinAndAsk();
  while (farm.Running(first).task.spec.id.frame < 6) farm.Finish(first);
  farm.Leave(first);
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 0), 4);
  EXPECT_EQ(farm.CountGrants(TaskKind::kAnalyse, 2), 2);
}

}  // namespace
}  // namespace depthfarm
