// Jobs that go on from what is there already: committed frames, and results that workers keep.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "common/digest/sha256.h"
#include "coordinator/scheduling/scheduler.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLease{6000};

// Runs a job until so many frames are committed, and goes on with them on a farm that knows nothing else.
class Resumed : public testing::TestWithParam<std::tuple<Anchor, int>> {};

TEST_P(Resumed, AJobGoesOnFromItsCommittedFrames) {
  const auto [anchor, frames] = GetParam();
  const PlannedJob job = MakePlannedJob({.frames = 11, .gop = 3, .views = 2, .refine = 2, .anchor = anchor});
  FakeFarm before;
  before.Submit(job);
  before.JoinAndAsk();
  before.JoinAndAsk();
  while (before.committed[JobId(1)].size() < static_cast<std::size_t>(frames)) {
    for (auto& [id, fake] : before.workers) before.Finish(id);
  }
  const CommittedFrames committed = before.committed.at(JobId(1));
  before.RunToTheEnd();
  const auto manifest_of = [](const FakeFarm& farm) {
    const auto is_manifest = [](const Grant& grant) { return grant.task.spec.id.kind == TaskKind::kManifest; };
    return std::ranges::find_if(farm.grants, is_manifest)->task.spec;
  };

  FakeFarm after;
  after.Resume(job, committed);
  after.JoinAndAsk();
  EXPECT_EQ(after.grants.at(0).task.spec.files.size(), 2 * committed.size()) << "what Prepare must find";
  after.RunToTheEnd();
  EXPECT_EQ(after.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(after.ended.at(JobId(1)).frames_done, 11);
  for (int frame = 0; frame < 11; ++frame) {
    EXPECT_EQ(after.CountGrants(TaskKind::kEmit, frame), committed.contains(frame) ? 0 : 1) << frame;
    EXPECT_EQ(after.CountGrants(TaskKind::kCommit, frame), committed.contains(frame) ? 0 : 1) << frame;
  }
  EXPECT_EQ(manifest_of(after).picture_digests, manifest_of(before).picture_digests);
  ASSERT_EQ(manifest_of(after).files.size(), manifest_of(before).files.size());
  for (const StageSnapshot& stage : after.ended.at(JobId(1)).stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);
  EXPECT_TRUE(after.scheduler.Jobs().empty());
  const auto whole_gop = [&](int gop) {
    const int end = std::min(11, 3 * gop + 3);
    for (int frame = 3 * gop; frame < end; ++frame)
      if (!committed.contains(frame)) return false;
    return true;
  };
  for (int gop = anchor == Anchor::kShared ? 1 : 0; gop < 4; ++gop) {
    if (!whole_gop(gop)) continue;
    for (int frame = 3 * gop; frame < std::min(11, 3 * gop + 3); ++frame)
      EXPECT_EQ(after.CountGrants(TaskKind::kAnalyse, frame), 0) << frame;
  }
  if (frames == 11) {
    EXPECT_EQ(after.grants.size(), 2U) << "Prepare and Manifest";
  }
}

INSTANTIATE_TEST_SUITE_P(Scheduler, Resumed,
                         testing::Combine(testing::Values(Anchor::kGop, Anchor::kShared),
                                          testing::Values(1, 3, 4, 6, 8, 10, 11)));

// Of a job that keeps its results, the bundle of a frame.
ArtifactKey BundleOf(const FakeFarm& farm, std::uint64_t job, int frame) {
  return farm.scheduler.ResultsOf(JobId(job))->frames.at(static_cast<std::size_t>(frame)).bundle.value().key;
}

TEST(KeptResultsOfAJob, AreArtifactsOfItsLastTasks) {
  FakeFarm farm;
  farm.Submit(
      MakePlannedJob({.frames = 3, .gop = 2, .views = 2, .refine = 1, .confidence = true, .keeps_results = true}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.RunToTheEnd();
  const JobSnapshot& job = farm.ended.at(JobId(1));
  EXPECT_EQ(job.state, JobState::kDone);
  EXPECT_TRUE(job.keeps_results);
  EXPECT_EQ(job.frames_done, 3);
  for (const TaskKind kind : {TaskKind::kPrepare, TaskKind::kCommit, TaskKind::kManifest, TaskKind::kCleanup})
    EXPECT_EQ(job.stages[static_cast<std::size_t>(kind)].tasks_total, 0U);
  for (const StageSnapshot& stage : job.stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);

  const JobResults* results = farm.scheduler.ResultsOf(JobId(1));
  ASSERT_NE(results, nullptr);
  ASSERT_EQ(results->frames.size(), 3U);
  EXPECT_EQ(results->picture_digests.at(3), Sha256("picture /in/cam1/1.png"));
  EXPECT_EQ(farm.keeps.size(), 3U);
  for (int frame = 0; frame < 3; ++frame) {
    const ArtifactKey key = BundleOf(farm, 1, frame);
    EXPECT_THAT(farm.scheduler.HoldersOf(key), testing::ElementsAre(worker));
    EXPECT_EQ(results->frames[static_cast<std::size_t>(frame)].files.size(), 4U);
    for (const Release& release : farm.releases) EXPECT_THAT(release.keys, testing::Not(testing::Contains(key)));
  }
}

TEST(KeptResultsOfAJob, AreReleasedWhenTheJobIsForgotten) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.id = 1, .frames = 2, .gop = 1, .keeps_results = true}));
  farm.Submit(MakePlannedJob({.id = 2, .frames = 1, .gop = 1, .keeps_results = true}));
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  const ArtifactKey shared = BundleOf(farm, 1, 0);
  const ArtifactKey own = BundleOf(farm, 1, 1);
  EXPECT_EQ(BundleOf(farm, 2, 0), shared);
  farm.releases.clear();
  farm.Send(JobForgotten{JobId(1)});
  EXPECT_EQ(farm.scheduler.ResultsOf(JobId(1)), nullptr);
  ASSERT_EQ(farm.releases.size(), 1U);
  EXPECT_THAT(farm.releases[0].keys, testing::ElementsAre(own));
  farm.Send(JobForgotten{JobId(2)});
  ASSERT_EQ(farm.releases.size(), 2U);
  EXPECT_THAT(farm.releases[1].keys, testing::ElementsAre(shared));
}

TEST(KeptResultsOfAJob, AreNamedToAWorkerThatComesBack) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 2, .gop = 1, .keeps_results = true}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.RunToTheEnd();
  farm.keeps.clear();
  farm.Rejoin(worker);
  ASSERT_EQ(farm.keeps.size(), 1U);
  EXPECT_THAT(farm.keeps[0].keys, testing::UnorderedElementsAre(BundleOf(farm, 1, 0), BundleOf(farm, 1, 1)));
}

TEST(KeptResultsOfAJob, AreMadeAgainWhenTheyAreLostWhileItRuns) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 6, .gop = 2, .views = 2, .refine = 1, .keeps_results = true}));
  const WorkerId worker = farm.JoinAndAsk();
  for (int i = 0; i < 1000 && farm.scheduler.Job(JobId(1))->frames_done < 3; ++i) farm.Finish(worker);
  ASSERT_EQ(farm.scheduler.Job(JobId(1))->frames_done, 3);
  // One frame of a GOP that is over, with all that its worker held of it, and one of the GOP that is open.
  const ArtifactKey closed = BundleOf(farm, 1, 0);
  const ArtifactKey open = BundleOf(farm, 1, 2);
  const ArtifactKey held = BundleOf(farm, 1, 1);
  const auto store = farm.At(worker).store;
  for (const auto& [key, artifact] : store) {
    if (key != held) farm.Drop(worker, key);
  }
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->frames_done, 1);
  farm.RunToTheEnd();
  const JobSnapshot& job = farm.ended.at(JobId(1));
  EXPECT_EQ(job.state, JobState::kDone) << job.error.message();
  for (const StageSnapshot& stage : job.stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);
  EXPECT_EQ(BundleOf(farm, 1, 0), closed);
  EXPECT_EQ(BundleOf(farm, 1, 2), open);
  EXPECT_EQ(farm.CountGrants(TaskKind::kEmit, 0), 2);
  EXPECT_EQ(farm.CountGrants(TaskKind::kEmit, 1), 1);
  EXPECT_EQ(farm.CountGrants(TaskKind::kRefine, 1), 4) << "what only a frame needed that is there is not made again";
  EXPECT_EQ(farm.CountGrants(TaskKind::kEmit, 2), 2);
}

TEST(KeptResultsOfAJob, ThatAreLostAgainAndAgainFailIt) {
  SchedulerOptions options;
  options.max_setbacks = 2;
  FakeFarm farm(options);
  farm.Submit(MakePlannedJob({.frames = 10, .gop = 1, .keeps_results = true}));
  const WorkerId worker = farm.JoinAndAsk();
  for (int i = 0; i < 1000 && !farm.ended.contains(JobId(1)); ++i) {
    if (farm.IsIdle(worker)) {
      farm.PassWithBeats(kLease / 6);
      continue;
    }
    farm.Finish(worker);
    if (farm.ended.contains(JobId(1)) || !farm.scheduler.ResultsOf(JobId(1))->frames[0].bundle) continue;
    farm.Drop(worker, BundleOf(farm, 1, 0));
  }
  ASSERT_TRUE(farm.ended.contains(JobId(1)));
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kFailed);
  EXPECT_THAT(farm.ended.at(JobId(1)).error.message(), testing::HasSubstr("are the workers' stores large enough?"));
}

// Runs a job that keeps its results until so many frames are done, and lets it go on under a scheduler that knows no
// more than these frames and, later, the worker that has them.
class ResumedKept : public testing::TestWithParam<std::tuple<Anchor, int>> {};

TEST_P(ResumedKept, AJobGoesOnFromItsBundles) {
  const auto [anchor, frames] = GetParam();
  const PlannedJob job =
      MakePlannedJob({.frames = 8, .gop = 3, .views = 2, .refine = 2, .anchor = anchor, .keeps_results = true});
  FakeFarm before;
  before.Submit(job);
  const WorkerId worker = before.JoinAndAsk();
  while (before.committed[JobId(1)].size() < static_cast<std::size_t>(frames)) before.Finish(worker);
  const CommittedFrames committed = before.committed.at(JobId(1));

  FakeFarm after;
  after.Resume(job, committed);
  const WorkerId again = after.Join();
  after.At(again).store = before.At(worker).store;
  after.Rejoin(again);
  EXPECT_EQ(after.keeps.size(), 1U) << "what it must not drop";
  after.Ask(again);
  // One that is done is lost before the job ends.
  if (frames < 8) after.Drop(again, committed.begin()->second.bundle->key);
  after.RunToTheEnd();
  EXPECT_EQ(after.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(after.ended.at(JobId(1)).frames_done, 8);
  for (const auto& [frame, done] : committed) {
    const bool lost = frames < 8 && frame == committed.begin()->first;
    EXPECT_EQ(after.CountGrants(TaskKind::kEmit, frame), lost ? 1 : 0) << frame;
  }
  for (int frame = 0; frame < 8; ++frame)
    EXPECT_TRUE(after.scheduler.ResultsOf(JobId(1))->frames[static_cast<std::size_t>(frame)].bundle) << frame;
  for (const StageSnapshot& stage : after.ended.at(JobId(1)).stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);
}

TEST_P(ResumedKept, WhatNobodyAnnouncesIsMadeAgain) {
  const auto [anchor, frames] = GetParam();
  const PlannedJob job =
      MakePlannedJob({.frames = 8, .gop = 3, .views = 2, .refine = 2, .anchor = anchor, .keeps_results = true});
  FakeFarm before;
  before.Submit(job);
  const WorkerId worker = before.JoinAndAsk();
  while (before.committed[JobId(1)].size() < static_cast<std::size_t>(frames)) before.Finish(worker);

  FakeFarm after;
  after.committed = before.committed;
  after.Resume(job, before.committed.at(JobId(1)));
  after.JoinAndAsk();  // with nothing
  EXPECT_TRUE(after.ended.empty());
  after.RunToTheEnd();
  EXPECT_EQ(after.ended.at(JobId(1)).state, JobState::kDone);
  for (int frame = 0; frame < 8; ++frame) {
    EXPECT_EQ(after.CountGrants(TaskKind::kEmit, frame), 1) << frame;
    const auto bundle = after.scheduler.ResultsOf(JobId(1))->frames[static_cast<std::size_t>(frame)].bundle;
    ASSERT_TRUE(bundle) << frame;
    EXPECT_FALSE(after.scheduler.HoldersOf(bundle->key).empty()) << frame;
  }
  EXPECT_EQ(after.committed.at(JobId(1)).size(), 8U);
  for (const StageSnapshot& stage : after.ended.at(JobId(1)).stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);
}

// A job of higher priority has as many tasks ready as all slots want, so that the turn of its GOPs does not come.
TEST(ResumedWithAllFrames, AJobBehindOthersCountsTheTasksThatItDidBefore) {
  const PlannedJob job = MakePlannedJob({.frames = 5, .gop = 1, .views = 2});
  FakeFarm before;
  before.Submit(job);
  before.JoinAndAsk();
  before.RunToTheEnd();
  const CommittedFrames committed = before.committed.at(JobId(1));
  ASSERT_EQ(committed.size(), 5U);

  FakeFarm after({.ready_per_slot = 1});
  after.Submit(MakePlannedJob({.id = 2, .frames = 20, .gop = 1, .views = 4}), 1, {"ssd"});
  const WorkerId rival = after.Join();
  after.At(rival).tags = {"ssd"};
  after.Rejoin(rival);
  after.Ask(rival);
  const WorkerId worker = after.Join();
  after.Resume(job, committed);
  after.Ask(worker);
  while (!after.IsIdle(worker)) after.Finish(worker);
  ASSERT_TRUE(after.ended.contains(JobId(1)));
  EXPECT_EQ(after.ended.at(JobId(1)).state, JobState::kDone);
  for (const StageSnapshot& stage : after.ended.at(JobId(1)).stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);
}

// Whichever it is: one that refers to the I frame of the first GOP finds its tasks gone.
TEST(KeptResultsOfAJob, OneThatIsLostBeforeTheyAreConfirmedIsMadeAgain) {
  const PlannedJob job = MakePlannedJob(
      {.frames = 8, .gop = 3, .views = 2, .refine = 2, .anchor = Anchor::kShared, .keeps_results = true});
  FakeFarm before;
  before.Submit(job);
  const WorkerId worker = before.JoinAndAsk();
  before.RunToTheEnd();
  const CommittedFrames committed = before.committed.at(JobId(1));
  ASSERT_EQ(committed.size(), 8U);
  for (int lost = 0; lost < 8; ++lost) {
    SCOPED_TRACE(lost);
    FakeFarm after;
    after.Resume(job, committed);
    const WorkerId again = after.Join();
    for (const auto& [frame, done] : committed) {
      const ArtifactKey& key = done.bundle->key;
      if (frame != lost) after.At(again).store[key] = before.At(worker).store.at(key);
    }
    after.Rejoin(again);
    after.Ask(again);
    after.RunToTheEnd();
    EXPECT_EQ(after.ended.at(JobId(1)).state, JobState::kDone);
    for (int frame = 0; frame < 8; ++frame)
      EXPECT_EQ(after.CountGrants(TaskKind::kEmit, frame), frame == lost ? 1 : 0) << frame;
    for (const StageSnapshot& stage : after.ended.at(JobId(1)).stages) EXPECT_EQ(stage.tasks_done, stage.tasks_total);
  }
}

INSTANTIATE_TEST_SUITE_P(KeptResultsOfAJob, ResumedKept,
                         testing::Combine(testing::Values(Anchor::kGop, Anchor::kShared),
                                          testing::Values(1, 3, 4, 6, 7, 8)));

TEST(KeptResultsOfAJob, StayWhenTheJobIsCancelled) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({.frames = 4, .gop = 1, .keeps_results = true}));
  const WorkerId worker = farm.JoinAndAsk();
  for (int i = 0; i < 1000 && farm.scheduler.Job(JobId(1))->frames_done < 2; ++i) farm.Finish(worker);
  farm.Cancel(1);
  farm.PassWithBeats(kLease);
  ASSERT_TRUE(farm.ended.contains(JobId(1)));
  EXPECT_EQ(farm.ended.at(JobId(1)).frames_done, 2);
  EXPECT_EQ(farm.scheduler.HoldersOf(BundleOf(farm, 1, 0)).size(), 1U);
  farm.Drop(worker, BundleOf(farm, 1, 0));
  EXPECT_TRUE(farm.scheduler.HoldersOf(BundleOf(farm, 1, 0)).empty());
  EXPECT_EQ(farm.scheduler.JobWritingTo(""), std::nullopt);
}

}  // namespace
}  // namespace depthfarm
