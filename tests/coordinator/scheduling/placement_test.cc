#include "coordinator/scheduling/placement.h"

#include <gtest/gtest.h>

#include <vector>

#include "coordinator/planning/cost_model.h"
#include "coordinator/scheduling/task_table.h"

namespace depthfarm {
namespace {

TaskId Id(TaskKind kind, int frame, int index = 0) { return {JobId(1), frame, kind, index, 0}; }

const std::vector<WorkerId> kWorkers = {WorkerId(5), WorkerId(3)};

TEST(Placement, TheWorkerThatHoldsMostInputBytesGetsTheTask) {
  const std::vector<TaskCandidate> tasks = {
      {Id(TaskKind::kEstimate, 0, 0), {{WorkerId(5), 10}, {WorkerId(3), 20}}, {}}};
  EXPECT_EQ(ChoosePlacement(tasks, kWorkers), (Placement{tasks[0].task, WorkerId(3)}));
}

TEST(Placement, AmongEqualTasksTheOneWithMostBytesInPlaceGoes) {
  const std::vector<TaskCandidate> tasks = {{Id(TaskKind::kEstimate, 0, 0), {{WorkerId(5), 10}}, {}},
                                            {Id(TaskKind::kEstimate, 0, 1), {{WorkerId(3), 11}}, {}}};
  EXPECT_EQ(ChoosePlacement(tasks, kWorkers), (Placement{tasks[1].task, WorkerId(3)}));
}

TEST(Placement, TiesGoToTheFirstTaskAndTheLongestWaiting) {
  const std::vector<TaskCandidate> tasks = {{Id(TaskKind::kAnalyse, 0, 0), {}, {}},
                                            {Id(TaskKind::kAnalyse, 0, 1), {}, {}}};
  EXPECT_EQ(ChoosePlacement(tasks, kWorkers), (Placement{tasks[0].task, WorkerId(5)}));
}

TEST(Placement, AWorkerToAvoidGetsNothingHoweverMuchItHolds) {
  const std::vector<TaskCandidate> tasks = {{Id(TaskKind::kAnalyse, 0), {{WorkerId(5), 99}}, {WorkerId(5)}}};
  EXPECT_EQ(ChoosePlacement(tasks, kWorkers)->worker, WorkerId(3));
  EXPECT_EQ(ChoosePlacement(tasks, {kWorkers.data(), 1}), std::nullopt);
  EXPECT_EQ(ChoosePlacement(tasks, {}), std::nullopt);
}

TEST(Placement, HelpIsWorthWhatItReadsWhileEnoughIsLeft) {
  EXPECT_TRUE(IsHelpWorthReading(0, 0)) << "nothing to read";
  EXPECT_FALSE(IsHelpWorthReading(1, 0));
  const std::uint64_t read = 100'000'000;
  const double seconds = CostModel::SecondsToRead(read);
  EXPECT_FALSE(IsHelpWorthReading(read, 5 * seconds));
  EXPECT_TRUE(IsHelpWorthReading(read, 7 * seconds));
}

TEST(Urgency, EndingFramesComesBeforeNewWork) {
  const ByUrgency before;
  EXPECT_TRUE(before(Id(TaskKind::kEmit, 9), Id(TaskKind::kMerge, 0)));
  EXPECT_TRUE(before(Id(TaskKind::kCommit, 9), Id(TaskKind::kAnalyse, 0)));
  EXPECT_TRUE(before(Id(TaskKind::kCommit, 3), Id(TaskKind::kEmit, 3)));
}

TEST(Urgency, EarlierFramesComeFirstAndWithinAFrameLaterStages) {
  const ByUrgency before;
  EXPECT_TRUE(before(Id(TaskKind::kAnalyse, 1), Id(TaskKind::kMerge, 2)));
  EXPECT_TRUE(before(Id(TaskKind::kMerge, 2), Id(TaskKind::kEstimate, 2)));
  EXPECT_TRUE(before(Id(TaskKind::kEstimate, 2), Id(TaskKind::kAnalyse, 2)));
  EXPECT_TRUE(before(Id(TaskKind::kAnalyse, 2, 0), Id(TaskKind::kAnalyse, 2, 1)));
  EXPECT_FALSE(before(Id(TaskKind::kAnalyse, 2, 1), Id(TaskKind::kAnalyse, 2, 1)));
}

}  // namespace
}  // namespace depthfarm
