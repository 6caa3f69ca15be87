// Tasks that wait behind the slots of one worker while a slot of another is idle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "coordinator/planning/cost_model.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr Milliseconds kLease{6000};

TaskId Analyse(int view) { return {JobId(1), 0, TaskKind::kAnalyse, view, 0}; }

// One worker computes one of three analyses and has fetched for another; the third is ready.
class Rebalance : public testing::Test {
 protected:
  void SetUp() override {
    farm_.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = 3}));
    busy_ = farm_.JoinAndAsk(1, 1);
    farm_.Finish(busy_);  // Prepare
    ASSERT_THAT(farm_.At(busy_).running, SizeIs(2));
  }
  // Another one, which ends the third analysis: nothing is ready then.
  WorkerId JoinAndEndTheThird() {
    const WorkerId idle = farm_.JoinAndAsk(1, 1);
    EXPECT_THAT(farm_.asked_back, IsEmpty()) << "it has found something that was ready";
    farm_.Finish(idle);
    return idle;
  }
  [[nodiscard]] Grant Waiting() { return std::next(farm_.At(busy_).running.begin())->second; }

  FakeFarm farm_;
  WorkerId busy_;
};

TEST_F(Rebalance, WhatWaitsBehindASlotGoesToAWorkerThatIsIdle) {
  const Grant waiting = Waiting();
  const WorkerId idle = JoinAndEndTheThird();
  ASSERT_THAT(farm_.asked_back, SizeIs(1));
  EXPECT_EQ(farm_.asked_back[0].worker, busy_);
  EXPECT_EQ(farm_.asked_back[0].lease, waiting.lease);
  EXPECT_THAT(farm_.At(busy_).running, SizeIs(1));
  ASSERT_FALSE(farm_.IsIdle(idle));
  EXPECT_EQ(farm_.Running(idle).task.spec.id, waiting.task.spec.id);
}

TEST_F(Rebalance, CountsNoAttempt) {
  const Grant waiting = Waiting();
  const WorkerId idle = JoinAndEndTheThird();
  ASSERT_FALSE(farm_.IsIdle(idle));
  EXPECT_EQ(farm_.Running(idle).attempt, 1);
  EXPECT_EQ(farm_.attempts_ended.at(waiting.lease).outcome, AttemptOutcome::kGivenBack);
  EXPECT_EQ(farm_.CountNotes("task_failed"), 0);
  farm_.RunToTheEnd();
  EXPECT_EQ(farm_.ended.at(JobId(1)).state, JobState::kDone);
  EXPECT_EQ(farm_.ended.at(JobId(1)).retries, 0U);
}

TEST_F(Rebalance, WhatTheWorkerHasBegunMeanwhileStaysThere) {
  farm_.answers_late = true;
  const Grant waiting = Waiting();
  const WorkerId idle = JoinAndEndTheThird();
  ASSERT_THAT(farm_.asked_back, SizeIs(1));
  farm_.Finish(busy_);  // and begins the next
  farm_.AnswerAskedBack();
  EXPECT_TRUE(farm_.IsIdle(idle));
  EXPECT_EQ(farm_.Running(busy_).lease, waiting.lease);
  farm_.RunToTheEnd();
  for (int view = 0; view < 3; ++view) {
    EXPECT_EQ(std::ranges::count_if(farm_.grants, [&](const Grant& g) { return g.task.spec.id == Analyse(view); }), 1);
  }
}

TEST_F(Rebalance, NothingIsTakenBeforeTheWorkerHasAnswered) {
  farm_.answers_late = true;
  const Grant waiting = Waiting();
  const WorkerId idle = JoinAndEndTheThird();
  farm_.PassWithBeats(5 * kLease);
  EXPECT_THAT(farm_.asked_back, SizeIs(1)) << "asked once";
  EXPECT_TRUE(farm_.IsIdle(idle));
  EXPECT_FALSE(farm_.attempts_ended.contains(waiting.lease));
  farm_.AnswerAskedBack();
  EXPECT_EQ(farm_.Running(idle).task.spec.id, waiting.task.spec.id);
}

TEST_F(Rebalance, AnAttemptIsAskedBackOnceThoughTheIdleWorkerIsGone) {
  farm_.answers_late = true;
  farm_.Leave(JoinAndEndTheThird());
  ASSERT_THAT(farm_.asked_back, SizeIs(1));
  const WorkerId another = farm_.JoinAndAsk();
  EXPECT_THAT(farm_.asked_back, SizeIs(1));
  farm_.AnswerAskedBack();
  EXPECT_FALSE(farm_.IsIdle(another)) << "it is anybody's now";
  farm_.RunToTheEnd();
  EXPECT_EQ(farm_.ended.at(JobId(1)).state, JobState::kDone);
}

TEST_F(Rebalance, ATaskForEachIdleWorker) {
  farm_.Submit(MakePlannedJob({.id = 2, .frames = 1, .gop = 1, .views = 8}));
  const WorkerId second = farm_.JoinAndAsk(1, 4);
  farm_.Finish(second);
  ASSERT_GT(farm_.At(second).running.size(), 2U);
  farm_.answers_late = true;
  std::vector<WorkerId> idle;
  for (int i = 0; i < 40 && idle.size() < 2; ++i) {
    const WorkerId worker = farm_.JoinAndAsk();
    if (farm_.IsIdle(worker)) idle.push_back(worker);
  }
  ASSERT_THAT(idle, SizeIs(2));
  EXPECT_THAT(farm_.asked_back, SizeIs(2));
  farm_.AnswerAskedBack();
  for (const WorkerId worker : idle) EXPECT_FALSE(farm_.IsIdle(worker));
}

TEST_F(Rebalance, NobodyIsAskedForAWorkerThatCannotHaveIt) {
  const WorkerId third = farm_.JoinAndAsk();
  const WorkerId small = farm_.Join();
  farm_.At(small).memory_bytes = 1;
  farm_.Rejoin(small);
  farm_.Ask(small);
  EXPECT_TRUE(farm_.IsIdle(small));
  EXPECT_THAT(farm_.asked_back, IsEmpty());
  farm_.Finish(third);
  EXPECT_THAT(farm_.asked_back, SizeIs(1));
  EXPECT_TRUE(farm_.IsIdle(small));
  EXPECT_FALSE(farm_.IsIdle(third));
}

TEST_F(Rebalance, NobodyIsAskedForAWorkerWithoutTheTagsOfTheJob) {
  FakeFarm farm;
  const WorkerId tagged = farm.Join(1, 1);
  farm.At(tagged).tags = {"fast"};
  farm.Rejoin(tagged);
  farm.Ask(tagged);
  farm.Submit(MakePlannedJob({.frames = 1, .gop = 1, .views = 3}), 0, {"fast"});
  farm.Finish(tagged);
  ASSERT_THAT(farm.At(tagged).running, SizeIs(2));
  farm.JoinAndAsk();
  EXPECT_THAT(farm.asked_back, IsEmpty());
}

TEST_F(Rebalance, ARevokedTaskIsNotAskedBack) {
  farm_.answers_late = true;
  farm_.Cancel(1);
  farm_.JoinAndAsk();
  EXPECT_THAT(farm_.asked_back, IsEmpty());
}

// Random farms without failures, where answers come at once or late.
class CalmFarm {
 public:
  explicit CalmFarm(std::uint32_t seed) : random_(seed) {
    const int jobs = 1 + Below(3);
    for (int job = 1; job <= jobs; ++job) {
      farm.Submit(MakePlannedJob({.id = static_cast<std::uint64_t>(job),
                                  .frames = 1 + Below(6),
                                  .gop = 1 + Below(4),
                                  .views = 2 + Below(5),
                                  .blocks_i = 1 + Below(4),
                                  .refine = Below(3)}));
    }
    for (int i = 0; i < 2 + Below(4); ++i) farm.JoinAndAsk(1 + Below(3), Below(5));
  }

  // One of the tasks that some slot computes ends; rarely, somebody joins.
  void Step() {
    if (Below(50) == 0 && farm.workers.size() < 10) farm.JoinAndAsk(1 + Below(2), Below(3));
    if (Below(5) == 0) Answer();
    const auto worker = std::next(farm.workers.begin(), Below(static_cast<int>(farm.workers.size())));
    std::vector<LeaseId> computing;
    for (const auto& [lease, grant] : worker->second.running) {
      if (farm.begun.contains(lease)) computing.push_back(lease);
    }
    if (!computing.empty()) {
      farm.Finish(worker->first, computing[static_cast<std::size_t>(Below(static_cast<int>(computing.size())))]);
    } else if (worker->second.HasRoom()) {
      farm.Ask(worker->first);
    }
  }
  void Answer() {
    const bool late = std::exchange(farm.answers_late, false);
    farm.AnswerAskedBack();
    farm.answers_late = late;
  }
  [[nodiscard]] bool AnyIdleSlot() const {
    return std::ranges::any_of(farm.workers, [](const auto& entry) {
      return entry.second.running.size() < static_cast<std::size_t>(entry.second.slots);
    });
  }
  // Tasks that no slot has begun and that nobody was asked for, yet.
  [[nodiscard]] int WaitingUnasked() const {
    std::set<TaskId> asked;
    for (const AskBack& ask : farm.asked_back) asked.insert(TaskOf(ask.lease));
    int count = 0;
    for (const auto& [id, worker] : farm.workers) {
      for (const auto& [lease, grant] : worker.running) {
        count += farm.begun.contains(lease) || asked.contains(grant.task.spec.id) ? 0 : 1;
      }
    }
    return count;
  }
  [[nodiscard]] TaskId TaskOf(LeaseId lease) const {
    return std::ranges::find(farm.grants, lease, &Grant::lease)->task.spec.id;
  }

  FakeFarm farm;

 private:
  int Below(int bound) { return static_cast<int>(random_() % static_cast<std::uint32_t>(bound)); }
  std::mt19937 random_;
};

TEST(RebalanceProperty, NoTaskIsComputedTwiceOrAskedBackTwice) {
  int moved = 0;
  int kept = 0;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    CalmFarm calm(seed);
    FakeFarm& farm = calm.farm;
    farm.answers_late = seed % 2 == 0;
    for (int step = 0; step < 20'000 && !farm.scheduler.Jobs().empty(); ++step) calm.Step();
    ASSERT_TRUE(farm.scheduler.Jobs().empty()) << "the farm does not come to an end";
    std::map<TaskId, int> computed;
    std::map<TaskId, int> granted;
    for (const Grant& grant : farm.grants) {
      computed[grant.task.spec.id] += farm.begun.contains(grant.lease) ? 1 : 0;
      ++granted[grant.task.spec.id];
      EXPECT_EQ(grant.attempt, 1);
    }
    for (const auto& [task, times] : computed) EXPECT_EQ(times, 1) << TaskName(task);
    std::set<TaskId> asked;
    for (const AskBack& ask : farm.asked_back) {
      const TaskId task = calm.TaskOf(ask.lease);
      EXPECT_TRUE(asked.insert(task).second) << TaskName(task) << " was asked back twice";
      (granted[task] == 2 ? moved : kept) += 1;
    }
    for (const auto& [task, times] : granted) EXPECT_LE(times, asked.contains(task) ? 2 : 1) << TaskName(task);
    for (const auto& [id, job] : farm.ended) {
      EXPECT_EQ(job.state, JobState::kDone);
      EXPECT_EQ(job.retries, 0U);
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(moved, 100);
  EXPECT_GT(kept, 10) << "some should have been begun before the worker was asked";
}

TEST(RebalanceProperty, NoSlotIsIdleWhileATaskWaitsBehindAnotherOne) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    CalmFarm calm(seed);
    for (int step = 0; step < 20'000 && !calm.farm.scheduler.Jobs().empty(); ++step) {
      calm.Step();
      EXPECT_FALSE(calm.AnyIdleSlot() && calm.WaitingUnasked() > 0) << "step " << step;
      if (testing::Test::HasFailure()) return;
    }
    ASSERT_TRUE(calm.farm.scheduler.Jobs().empty());
  }
}

}  // namespace
}  // namespace depthfarm
