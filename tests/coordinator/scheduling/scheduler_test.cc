#include "coordinator/scheduling/scheduler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/digest/sha256.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLease{6000};

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

TEST(Scheduler, TheBacklogIsWhatWorkersOfTheseTagsCouldDo) {
  FakeFarm farm;
  EXPECT_EQ(farm.scheduler.BacklogOf({}).ready, 0U);
  farm.Submit(MakePlannedJob({.id = 1, .frames = 8, .gop = 2, .views = 3}));
  const Backlog before = farm.scheduler.BacklogOf({});
  EXPECT_EQ(before.leased, 0U);
  EXPECT_EQ(before.ready, 1U) << "Prepare";
  EXPECT_EQ(before.unopened_gops, 4U) << "without a worker none is opened";
  farm.Submit(MakePlannedJob({.id = 2, .frames = 2, .gop = 1}), 0, {"gpu"});
  EXPECT_EQ(farm.scheduler.BacklogOf({}).unopened_gops, 4U) << "no worker without the tag takes that job";
  EXPECT_EQ(farm.scheduler.BacklogOf({"gpu"}).unopened_gops, 6U);
  EXPECT_EQ(farm.scheduler.TotalBacklog().unopened_gops, 6U);
  const WorkerId worker = farm.JoinAndAsk();
  EXPECT_EQ(farm.scheduler.BacklogOf({}).leased, 1U);
  farm.Finish(worker);
  const Backlog during = farm.scheduler.BacklogOf({});
  EXPECT_EQ(during.leased, 1U);
  EXPECT_GT(during.ready, 0U);
  farm.Cancel(2);
  farm.RunToTheEnd();
  const Backlog after = farm.scheduler.BacklogOf({"gpu"});
  EXPECT_EQ(after.leased + after.ready + after.unopened_gops, 0U);
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

TEST(Scheduler, TheJobConfigGoesAgainAfterATaskWasGivenBack) {
  FakeFarm farm;
  farm.Submit(MakePlannedJob({}));
  const WorkerId worker = farm.JoinAndAsk();
  farm.Finish(worker);
  farm.Fail(worker, Status(ErrorCode::kLeaseExpired, "this worker was never told of the job"));
  EXPECT_TRUE(farm.Running(worker).first_of_job);
  EXPECT_EQ(farm.Running(worker).attempt, 1);  // nobody's failure
  farm.Finish(worker);
  EXPECT_FALSE(farm.Running(worker).first_of_job);
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
    while (farm.IsIdle(worker)) farm.PassWithBeats(kLease / 6);  // until the task may be tried again
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
  farm.stops_late = true;
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
  farm.Fail(first, Cancelled());
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
  farm.PassWithBeats(kLease / 6);
  EXPECT_EQ(RunUntil(farm, worker, TaskKind::kEmit).task.spec.id, emit.task.spec.id);
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

TEST(Scheduler, CountsWhatTasksLeftAsideAndNamesTheFirstOfThem) {
  FakeFarm farm;
  const auto analyse = [](int frame, int view) { return TaskId{JobId(1), frame, TaskKind::kAnalyse, view}; };
  farm.left_aside = {analyse(1, 0), analyse(0, 1), analyse(1, 1)};
  farm.Submit(MakePlannedJob({.frames = 2, .views = 2}));
  farm.JoinAndAsk();
  farm.RunToTheEnd();
  const auto& stages = farm.ended.at(JobId(1)).stages;
  const StageSnapshot& analyses = stages[static_cast<std::size_t>(TaskKind::kAnalyse)];
  EXPECT_EQ(analyses.left_aside, 3U);
  EXPECT_EQ(analyses.first_left_aside, analyse(0, 1));
  EXPECT_EQ(stages[static_cast<std::size_t>(TaskKind::kEstimate)].left_aside, 0U);
}

TEST(Scheduler, TellsWhatIsLeftOfAJobOnItsShareOfTheFarm) {
  FakeFarm farm;
  const PlannedJob job = MakePlannedJob({.frames = 20, .gop = 1});
  farm.Submit(job);
  const WorkerId worker = farm.JoinAndAsk();
  const auto left = [&] { return farm.scheduler.Job(JobId(1))->seconds_left; };
  EXPECT_FALSE(left());
  for (int tasks = 0; tasks < 10; ++tasks) farm.Finish(worker);
  ASSERT_TRUE(left());
  const double alone = *left();
  EXPECT_GT(alone, 0);

  farm.Submit(MakePlannedJob({.id = 2}), -1);
  EXPECT_EQ(*left(), alone) << "a job behind it takes nothing";
  farm.Submit(MakePlannedJob({.id = 3}));
  EXPECT_NEAR(*left(), 2 * alone, 1e-9 * alone);
  farm.Join(2);
  EXPECT_NEAR(*left(), 2 * alone / 3, 1e-9 * alone);

  farm.Cancel(1);
  EXPECT_FALSE(left());
}

// A job whose submitter serves its pictures.
PlannedJob MakeUploadedJob() {
  PlannedJob job = MakePlannedJob({.frames = 2, .views = 2});
  for (std::uint8_t view = 0; view < 2; ++view) {
    job.uploads.emplace_back();
    for (std::uint8_t frame = 0; frame < 2; ++frame)
      job.uploads.back().push_back(
          {.picture = {{{view, frame}, 7}, {8}}, .mask = {}, .prior = {}, .prior_confidence = {}});
  }
  job.uploads_from = {"tcp://submitter:7", ""};
  return job;
}

TEST(Scheduler, TasksThatReadUploadsAreToldWhatAndWhere) {
  FakeFarm farm;
  farm.Send(JobSubmitted{MakeUploadedJob(), "job", 0, {}, {}, false, true});
  const WorkerId worker = farm.JoinAndAsk();
  const Grant analyse = RunUntil(farm, worker, TaskKind::kAnalyse);
  ASSERT_TRUE(analyse.task.spec.uploads.has_value());
  EXPECT_EQ(analyse.task.spec.uploads->from.endpoint, "tcp://submitter:7");
  const auto view = static_cast<std::uint8_t>(analyse.task.spec.id.index);
  EXPECT_EQ(analyse.task.spec.uploads->files.picture, (UploadedFile{{{view, 0}, 7}, {8}}));
}

TEST(Scheduler, AJobWithUploadsFailsWhenItsSubmitterIsSilent) {
  FakeFarm farm;
  farm.Send(JobSubmitted{MakeUploadedJob(), "job", 0, {}, {}, false, true});
  farm.Submit(MakePlannedJob({.id = 2}));
  for (int i = 0; i < 4; ++i) {
    farm.Pass(milliseconds(20'000));
    farm.Send(SubmitterHeard{JobId(1)});
    farm.Send(SubmitterHeard{JobId(2)});  // has none
    farm.Send(SubmitterHeard{JobId(9)});
  }
  EXPECT_TRUE(farm.ended.empty());
  farm.Pass(milliseconds(29'999));
  EXPECT_TRUE(farm.ended.empty());
  farm.Pass(milliseconds(1));
  ASSERT_TRUE(farm.ended.contains(JobId(1)));
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kFailed);
  EXPECT_THAT(farm.ended.at(JobId(1)).error.message(), testing::HasSubstr("was silent for 30 s"));
  EXPECT_FALSE(farm.ended.contains(JobId(2)));
}

}  // namespace
}  // namespace depthfarm
