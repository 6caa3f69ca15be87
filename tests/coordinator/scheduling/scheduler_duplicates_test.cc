// Tasks that take too long while a worker is idle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr Milliseconds kLeast{5000};  // SchedulerOptions::straggler_least
constexpr Milliseconds kLonger{2000};

// All analyses of a frame are done, each after a second, but one: `slow` has it, `idle` has nothing to do.
class Duplicates : public testing::Test {
 protected:
  static constexpr int kViews = 6;
  void Begin(FakeFarm& farm, bool keeps_results = false) {
    farm.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = kViews, .keeps_results = keeps_results}));
    idle_ = farm.JoinAndAsk();
    if (!keeps_results) farm.Finish(idle_);  // Prepare
    slow_ = farm.JoinAndAsk();
    late_ = farm.Running(slow_);
    ASSERT_EQ(late_.task.spec.id.kind, TaskKind::kAnalyse);
    while (!farm.IsIdle(idle_)) farm.Finish(idle_);
  }
  void BeginAndWait(FakeFarm& farm) {
    Begin(farm);
    farm.PassWithBeats(kLeast + kLonger);
    ASSERT_FALSE(farm.IsIdle(idle_));
    second_ = farm.Running(idle_);
  }
  [[nodiscard]] static std::uint64_t AnalysesDone(const FakeFarm& farm) {
    return farm.scheduler.Job(JobId(1))->stages[static_cast<std::size_t>(TaskKind::kAnalyse)].tasks_done;
  }

  FakeFarm farm_;
  WorkerId idle_;
  WorkerId slow_;
  Grant late_;
  Grant second_;
};

TEST_F(Duplicates, AreOfWhatTakesTooLongForAWorkerThatIsIdle) {
  Begin(farm_);
  farm_.PassWithBeats(kLeast - kLonger);
  EXPECT_TRUE(farm_.IsIdle(idle_)) << "too early to say";
  farm_.PassWithBeats(2 * kLonger);
  ASSERT_FALSE(farm_.IsIdle(idle_));
  const Grant& grant = farm_.Running(idle_);
  EXPECT_EQ(grant.task.spec.id, late_.task.spec.id);
  EXPECT_TRUE(grant.duplicate);
  EXPECT_EQ(grant.attempt, 1);
  EXPECT_EQ(farm_.scheduler.Job(JobId(1))->duplicates, 1U);
  EXPECT_TRUE(farm_.scheduler.IsDuplicate(grant.lease));
  EXPECT_FALSE(farm_.scheduler.IsDuplicate(late_.lease));
  EXPECT_EQ(farm_.scheduler.TotalBacklog().leased, 1U) << "one task, whoever has it";
}

TEST_F(Duplicates, TheFirstResultCountsAndTheOtherAttemptIsRevoked) {
  BeginAndWait(farm_);
  farm_.Finish(idle_);
  EXPECT_EQ(AnalysesDone(farm_), 6U);
  ASSERT_THAT(farm_.revokes, SizeIs(1));
  EXPECT_EQ(farm_.revokes[0].lease, late_.lease);
  EXPECT_EQ(farm_.attempts_ended.at(second_.lease).outcome, AttemptOutcome::kDone);
  EXPECT_EQ(farm_.attempts_ended.at(late_.lease).outcome, AttemptOutcome::kOvertaken);
  EXPECT_EQ(farm_.scheduler.Job(JobId(1))->duplicates_won, 1U);
  EXPECT_EQ(farm_.scheduler.Job(JobId(1))->retries, 0U);
  farm_.Send(farm_.ResultOf(farm_.At(slow_), late_));  // was on its way
  EXPECT_EQ(AnalysesDone(farm_), 6U) << "counted once";
  farm_.RunToTheEnd();
  EXPECT_EQ(farm_.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm_.ended.at(JobId(1)).determinism_violations, 0U);
}

TEST_F(Duplicates, TheFirstAttemptMayStillBeFirst) {
  BeginAndWait(farm_);
  farm_.Finish(slow_);
  EXPECT_EQ(AnalysesDone(farm_), 6U);
  EXPECT_EQ(farm_.attempts_ended.at(second_.lease).outcome, AttemptOutcome::kOvertaken);
  EXPECT_EQ(farm_.scheduler.Job(JobId(1))->duplicates_won, 0U);
  EXPECT_FALSE(farm_.At(idle_).running.contains(second_.lease));
}

TEST_F(Duplicates, TheirFailuresAreNoFailuresOfTheTask) {
  BeginAndWait(farm_);
  farm_.Fail(idle_, Internal("it broke"));
  EXPECT_TRUE(farm_.IsIdle(idle_));
  EXPECT_EQ(farm_.scheduler.Job(JobId(1))->retries, 0U);
  farm_.PassWithBeats(10 * kLeast);
  EXPECT_TRUE(farm_.IsIdle(idle_)) << "a task has one in its life";
  farm_.Finish(slow_);
  EXPECT_EQ(farm_.attempts_ended.at(late_.lease).outcome, AttemptOutcome::kDone);
}

TEST_F(Duplicates, GoOnWhereTheFirstAttemptFails) {
  BeginAndWait(farm_);
  farm_.Fail(slow_, Internal("it broke"));
  EXPECT_EQ(farm_.scheduler.Job(JobId(1))->retries, 1U);
  farm_.PassWithBeats(kLonger);
  EXPECT_TRUE(farm_.IsIdle(slow_)) << "the task is not ready: it goes on";
  farm_.Finish(idle_);
  EXPECT_EQ(AnalysesDone(farm_), 6U);
  EXPECT_EQ(farm_.attempts_ended.at(second_.lease).outcome, AttemptOutcome::kDone);
}

TEST_F(Duplicates, WhereBothAttemptsEndWithoutAResultTheTaskIsTriedAgain) {
  BeginAndWait(farm_);
  farm_.Kill(slow_);
  farm_.PassWithBeats(Milliseconds(7000));
  EXPECT_EQ(farm_.attempts_ended.at(late_.lease).outcome, AttemptOutcome::kWorkerLost);
  EXPECT_EQ(farm_.CountGrants(TaskKind::kAnalyse, 0), kViews + 1);
  farm_.Fail(idle_, Internal("it broke"));
  farm_.PassWithBeats(kLonger);
  ASSERT_FALSE(farm_.IsIdle(idle_));
  EXPECT_EQ(farm_.Running(idle_).task.spec.id, late_.task.spec.id);
  EXPECT_EQ(farm_.Running(idle_).attempt, 2);
  farm_.RunToTheEnd();
  EXPECT_EQ(farm_.ended.at(JobId(1)).state, JobState::kDone);
}

TEST_F(Duplicates, TheLastAttemptsFailureWaitsForThem) {
  SchedulerOptions options;
  options.max_attempts = 1;
  FakeFarm farm(options);
  BeginAndWait(farm);
  farm.Fail(slow_, Internal("it broke"));
  EXPECT_TRUE(farm.scheduler.Job(JobId(1))->error.ok());
  farm.Fail(idle_, Internal("it broke, too"));
  EXPECT_FALSE(farm.scheduler.Job(JobId(1))->error.ok());
}

TEST_F(Duplicates, ThatAreGivenBackAfterTheLastAttemptFailedAreNoFurtherAttempt) {
  SchedulerOptions options;
  options.max_attempts = 1;
  FakeFarm farm(options);
  BeginAndWait(farm);
  farm.Fail(slow_, Internal("it broke"));
  farm.Fail(idle_, Cancelled());
  EXPECT_EQ(farm.scheduler.Job(JobId(1))->error.message(),
            TaskName(late_.task.spec.id) + " failed 1 times, the last time: it broke");
}

TEST_F(Duplicates, ThatSucceededAfterTheLastAttemptFailedLeaveAnAttemptForALostArtifact) {
  SchedulerOptions options;
  options.max_attempts = 1;
  FakeFarm farm(options);
  BeginAndWait(farm);
  farm.Fail(slow_, Internal("it broke"));
  const auto result = farm.ResultOf(farm.At(idle_), second_);
  farm.Finish(idle_);
  farm.Drop(idle_, result.artifact->key);
  farm.RunToTheEnd();
  EXPECT_EQ(farm.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_TRUE(std::ranges::all_of(farm.grants, [](const Grant& grant) { return grant.attempt == 1; }));
}

TEST_F(Duplicates, EndWithTheirJob) {
  BeginAndWait(farm_);
  farm_.Cancel(1);
  EXPECT_EQ(farm_.attempts_ended.at(late_.lease).outcome, AttemptOutcome::kRevoked);
  EXPECT_EQ(farm_.attempts_ended.at(second_.lease).outcome, AttemptOutcome::kRevoked);
  farm_.RunToTheEnd();
}

TEST_F(Duplicates, CanBeTurnedOff) {
  SchedulerOptions options;
  options.duplicates = false;
  FakeFarm farm(options);
  Begin(farm);
  farm.PassWithBeats(20 * kLeast);
  EXPECT_TRUE(farm.IsIdle(idle_));
}

TEST_F(Duplicates, AreNotMadeOnTheWorkerThatIsSlow) {
  farm_.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = kViews}));
  const WorkerId only = farm_.JoinAndAsk(2);
  farm_.Finish(only);
  while (farm_.At(only).running.size() == 2) farm_.Finish(only, std::next(farm_.At(only).running.begin())->first);
  farm_.PassWithBeats(20 * kLeast);
  EXPECT_THAT(farm_.At(only).running, SizeIs(1));
}

TEST_F(Duplicates, OfATaskThatWasLostWithAWorkerThereAreNone) {
  Begin(farm_);
  farm_.Kill(slow_);
  farm_.PassWithBeats(Milliseconds(7000));
  ASSERT_EQ(farm_.Running(idle_).task.spec.id, late_.task.spec.id) << "its second attempt";
  const WorkerId another = farm_.JoinAndAsk();
  farm_.PassWithBeats(20 * kLeast);
  EXPECT_TRUE(farm_.IsIdle(another));
}

// Emit writes into a folder, or makes a bundle.
TEST_F(Duplicates, AreOfTasksThatMakeAnArtifactAlone) {
  for (const bool keeps_results : {false, true}) {
    FakeFarm farm;
    farm.Submit(MakePlannedJob({.frames = 8, .gop = 1, .blocks_i = 1, .keeps_results = keeps_results}));
    const WorkerId quick = farm.JoinAndAsk();
    int emits = 0;
    while (emits < 6) {
      emits += farm.Running(quick).task.spec.id.kind == TaskKind::kEmit ? 1 : 0;
      farm.Finish(quick);
    }
    while (farm.Running(quick).task.spec.id.kind != TaskKind::kEmit) farm.Finish(quick);
    const WorkerId other = farm.JoinAndAsk();
    while (!farm.IsIdle(other) && farm.Running(other).task.spec.id.kind != TaskKind::kEmit) farm.Finish(other);
    const std::size_t before = farm.grants.size();
    const bool is_idle = farm.IsIdle(other);
    if (!is_idle) {  // its own emit
      farm.Finish(other);
      while (!farm.IsIdle(other)) farm.Finish(other);
    }
    farm.PassWithBeats(4 * kLeast);
    const bool again = std::any_of(farm.grants.begin() + static_cast<std::ptrdiff_t>(before), farm.grants.end(),
                                   [](const Grant& grant) { return grant.duplicate; });
    EXPECT_EQ(again, keeps_results);
  }
}

TEST_F(Duplicates, AreBoundedForTheWholeFarm) {
  farm_.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = 12}));
  const WorkerId quick = farm_.JoinAndAsk();
  farm_.Finish(quick);
  std::vector<WorkerId> slow;
  for (int i = 0; i < 5; ++i) slow.push_back(farm_.JoinAndAsk());
  while (!farm_.IsIdle(quick)) farm_.Finish(quick);
  std::vector<WorkerId> idle{quick};
  for (int i = 0; i < 2; ++i) idle.push_back(farm_.JoinAndAsk());
  farm_.PassWithBeats(2 * kLeast);
  EXPECT_EQ(std::ranges::count_if(farm_.grants, [](const Grant& grant) { return grant.duplicate; }), 2)
      << "of eight slots";
}

}  // namespace
}  // namespace depthfarm
