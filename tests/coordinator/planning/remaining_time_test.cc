#include "coordinator/planning/remaining_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <vector>

#include "tests/coordinator/planned_job.h"

namespace depthfarm {
namespace {

// Pictures of 1024x768, so that tasks take seconds. Points travel 100 pixels from a camera to the next, so that all
// levels are tried.
PlannedJob LargeJob(const JobShape& shape) {
  PlannedJob job = MakePlannedJob(shape);
  ResolvedJob& resolved = job.config.resolved;
  for (JobView& view : resolved.views) {
    view.camera.intrinsics << 1000, 0, 511.5, 0, 1000, 383.5, 0, 0, 1;
    view.camera.cam_from_world_translation.x() = -0.2 * static_cast<double>(&view - resolved.views.data());
    view.camera.width = view.source_width = 1024;
    view.camera.height = view.source_height = 768;
    view.segments = 39'000;
  }
  resolved.params.levels = 96;
  resolved.reference = resolved.views.front().camera;
  return job;
}

using Seconds = std::function<double(const TaskId&, double predicted)>;

// Plays a job through on so many slots, earliest frame first, each task taking what `actual` says, and keeps what is
// expected to be left at each end of a task.
class Play {
 public:
  Play(const PlannedJob& job, int slots, const Seconds& actual)
      : plan_(job), costs_(plan_.resolved()), remaining_(plan_, costs_) {
    Grant(plan_.OfJob(TaskKind::kPrepare), actual);
    for (int gop = 0; gop < plan_.num_gops(); ++gop) {
      for (const TaskId& id : plan_.TasksOfGop(gop)) waiting_.insert(id);
    }
    while (!running_.empty() || !waiting_.empty()) {
      while (static_cast<int>(running_.size()) < slots) {
        const auto ready = std::ranges::find_if(waiting_, [&](const TaskId& id) { return IsReady(id); });
        if (ready == waiting_.end()) break;
        const TaskId id = *ready;
        waiting_.erase(ready);
        Grant(id, actual);
      }
      EndNext(slots);
    }
  }

  [[nodiscard]] double total() const { return now_; }
  // Expected to what was left in fact, when this share of the time was over.
  [[nodiscard]] double ErrorAt(double share) const {
    const double at = share * now_;
    const auto told = std::ranges::find_if(told_, [&](const Told& one) { return one.at >= at; });
    if (told == told_.end() || !told->left) return 0;
    return *told->left / (now_ - told->at);
  }
  [[nodiscard]] std::optional<double> First() const { return told_.front().left; }

 private:
  struct Running {
    double ends;
    double started;
    TaskId id;
    bool operator<(const Running& other) const { return std::tie(ends, id) < std::tie(other.ends, other.id); }
  };
  struct Told {
    double at;
    std::optional<double> left;
  };

  bool IsReady(const TaskId& id) const {
    return std::ranges::all_of(plan_.Prerequisites(id), [&](const TaskId& needed) { return done_.contains(needed); });
  }
  void Grant(const TaskId& id, const Seconds& actual) {
    running_.insert({now_ + actual(id, costs_.Of(id).seconds), now_, id});
  }
  void EndNext(int slots) {
    const Running next = *running_.begin();
    running_.erase(running_.begin());
    now_ = next.ends;
    done_.insert(next.id);
    remaining_.Measured(next.id, next.ends - next.started);
    remaining_.Done(next.id);
    if (next.id.kind == TaskKind::kCommit && ++committed_[plan_.GopOf(next.id.frame)] == FramesOf(next.id.frame))
      remaining_.Close(plan_.GopOf(next.id.frame));
    std::vector<TaskId> computing;
    for (const Running& running : running_) computing.push_back(running.id);
    told_.push_back({now_, remaining_.Seconds(slots, computing)});
  }
  int FramesOf(int frame) const {
    const int gop = plan_.resolved().params.gop;
    return std::min(gop, plan_.resolved().num_frames - plan_.GopOf(frame) * gop);
  }

  JobPlan plan_;
  CostModel costs_;
  RemainingTime remaining_;
  double now_ = 0;
  std::set<Running> running_;
  struct ByFrame {
    bool operator()(const TaskId& a, const TaskId& b) const { return a < b; }
  };
  std::set<TaskId, ByFrame> waiting_;
  std::set<TaskId> done_;
  std::map<int, int> committed_;
  std::vector<Told> told_;
};

const Seconds kTwice = [](const TaskId&, double predicted) { return 2 * predicted; };

TEST(RemainingTime, IsRightWithinAQuarterWhenAllTakesTwiceAsLong) {
  for (const int slots : {1, 2, 4}) {
    const Play play(LargeJob({.frames = 24, .gop = 8, .views = 4, .blocks_i = 2, .refine = 6}), slots, kTwice);
    for (const double share : {0.3, 0.7}) {
      EXPECT_NEAR(play.ErrorAt(share), 1, 0.25) << slots << " slots, at " << share << " of " << play.total() << " s";
    }
  }
}

TEST(RemainingTime, IsRightForAChainThatLeavesSlotsIdle) {
  const Play play(LargeJob({.frames = 20, .gop = 20, .views = 2, .refine = 4}), 16, kTwice);
  for (const double share : {0.3, 0.7}) EXPECT_NEAR(play.ErrorAt(share), 1, 0.25) << share;
}

// Confidence takes long, and no frame waits for that of another.
TEST(RemainingTime, IsRightForAChainBesideTasksThatNoneWaitsFor) {
  const Play play(LargeJob({.frames = 20, .gop = 20, .views = 2, .refine = 4, .confidence = true}), 16, kTwice);
  for (const double share : {0.3, 0.7}) EXPECT_NEAR(play.ErrorAt(share), 1, 0.25) << share;
}

TEST(RemainingTime, CorrectsKindsAndFramesOfEachTypeByTheirOwn) {
  const Seconds actual = [](const TaskId& id, double predicted) {
    if (id.kind == TaskKind::kRefine) return (id.frame % 6 == 0 ? 1.5 : 5) * predicted;
    return id.kind == TaskKind::kAnalyse ? 0.5 * predicted : predicted;
  };
  const Play play(LargeJob({.frames = 60, .gop = 6, .views = 3, .refine = 6}), 2, actual);
  for (const double share : {0.3, 0.7}) EXPECT_NEAR(play.ErrorAt(share), 1, 0.25) << share;
}

TEST(RemainingTime, OfRenderingJobsLearnsWhatTheModelCannotKnow) {
  const Seconds actual = [](const TaskId& id, double) { return id.kind == TaskKind::kRender ? 20.0 : 0.01; };
  const Play play(MakeRenderingJob(1, 400), 3, actual);
  for (const double share : {0.3, 0.7}) EXPECT_NEAR(play.ErrorAt(share), 1, 0.25) << share;
}

TEST(RemainingTime, IsNotKnownBeforeAnythingRanOrWithoutSlots) {
  const JobPlan plan(LargeJob({.frames = 4, .gop = 2, .views = 2}));
  const CostModel costs(plan.resolved());
  RemainingTime remaining(plan, costs);
  EXPECT_FALSE(remaining.Seconds(4, {}));
  for (int view = 0; view < 2; ++view) {
    for (int frame = 0; frame < 2; ++frame) {
      const TaskId id{JobId(1), frame, TaskKind::kAnalyse, view, 0};
      EXPECT_EQ(remaining.Seconds(4, {}).has_value(), 2 * view + frame >= 3);
      remaining.Measured(id, 1);
      remaining.Done(id);
    }
  }
  EXPECT_TRUE(remaining.Seconds(4, {}));
  EXPECT_FALSE(remaining.Seconds(0, {}));
}

TEST(RemainingTime, OfOneTaskIsKnownOnceThreeOfItsKindWereMeasured) {
  const JobPlan plan(LargeJob({.frames = 4, .gop = 2, .views = 2}));
  const CostModel costs(plan.resolved());
  RemainingTime remaining(plan, costs);
  const TaskId i_frame{JobId(1), 0, TaskKind::kAnalyse, 0, 0};
  const TaskId p_frame{JobId(1), 1, TaskKind::kAnalyse, 0, 0};
  const double predicted = costs.Of(i_frame).seconds;
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(remaining.SecondsOf(i_frame));
    remaining.Measured(i_frame, 10 * predicted);
  }
  ASSERT_TRUE(remaining.SecondsOf(i_frame));
  EXPECT_GT(*remaining.SecondsOf(i_frame), 5 * predicted);
  EXPECT_LT(*remaining.SecondsOf(i_frame), 10 * predicted) << "three of them are not believed in full";
  EXPECT_FALSE(remaining.SecondsOf(p_frame));
}

TEST(RemainingTime, CountsWhatWasThereAlreadyAndWhatWasLostAgain) {
  const JobPlan plan(LargeJob({.frames = 8, .gop = 2, .views = 2, .refine = 4}));
  const CostModel costs(plan.resolved());
  RemainingTime remaining(plan, costs);
  for (int view = 0; view < 2; ++view) {
    for (int frame = 0; frame < 2; ++frame) {
      const TaskId id{JobId(1), frame, TaskKind::kAnalyse, view, 0};
      remaining.Measured(id, costs.Of(id).seconds);
      remaining.Done(id);
    }
  }
  const double before = *remaining.Seconds(1, {});
  const TaskId refine{JobId(1), 2, TaskKind::kRefine, 3, 0};
  remaining.Done(refine);
  const double after = *remaining.Seconds(1, {});
  EXPECT_NEAR(before - after, costs.Of(refine).seconds, 0.05 * costs.Of(refine).seconds);
  remaining.Undone(refine);
  EXPECT_NEAR(*remaining.Seconds(1, {}), before, 1e-9);
}

TEST(RemainingTime, OfAGopIsWhatItsTasksAreExpectedToTake) {
  const JobPlan plan(LargeJob({.frames = 5, .gop = 2, .views = 2, .refine = 4}));
  const CostModel costs(plan.resolved());
  RemainingTime remaining(plan, costs);
  for (const int gop : {0, 2}) {
    const std::vector<TaskId> tasks = plan.TasksOfGop(gop);
    double left = remaining.SecondsLeftOf(gop);
    double predicted = 0;
    for (const TaskId& id : tasks) predicted += costs.Of(id).seconds;
    EXPECT_NEAR(left, predicted, 0.1 * predicted) << "with what grants take";
    for (const TaskId& id : tasks) {
      remaining.Done(id);
      EXPECT_LT(remaining.SecondsLeftOf(gop), left);
      left = remaining.SecondsLeftOf(gop);
    }
    EXPECT_NEAR(left, 0, 1e-9);
  }
}

TEST(RemainingTime, IsNothingAtTheEnd) {
  const Play play(LargeJob({.frames = 5, .gop = 2, .views = 2, .blocks_i = 3, .refine = 4, .confidence = true}), 2,
                  [](const TaskId&, double predicted) { return predicted; });
  EXPECT_LT(play.ErrorAt(0.95), 1.5);
  EXPECT_GT(play.ErrorAt(0.95), 0.5);
}

}  // namespace
}  // namespace depthfarm
