#include "coordinator/forecast/critical_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/coordinator/forecast/sized_job.h"

namespace depthfarm {
namespace {

TEST(TaskGraph, HoldsEveryTaskAfterWhatItNeeds) {
  const JobPlan plan(MakeSizedJob({.frames = 5, .gop = 2, .views = 3, .blocks_i = 3, .refine = 2}));
  const CostModel model(plan.resolved());
  const TaskGraph graph(plan, model);
  std::uint64_t total = 0;
  for (int kind = 0; kind < kNumTaskKinds; ++kind) total += plan.Total(static_cast<TaskKind>(kind));
  ASSERT_EQ(graph.size(), total);
  EXPECT_EQ(graph.task(0).kind, TaskKind::kPrepare);
  EXPECT_EQ(graph.task(static_cast<TaskGraph::Index>(graph.size() - 1)).kind, TaskKind::kManifest);
  EXPECT_EQ(graph.Needs(static_cast<TaskGraph::Index>(graph.size() - 1)).size(), 5U) << "every Commit";
  ASSERT_EQ(graph.num_gops(), 3U);
  for (TaskGraph::Index index = 1; index + 1 < graph.size(); ++index) {
    std::vector<TaskId> needed;
    for (const TaskGraph::Index other : graph.Needs(index)) {
      EXPECT_LT(other, index);
      EXPECT_THAT(graph.NeededBy(other), testing::Contains(index));
      needed.push_back(graph.task(other));
    }
    EXPECT_THAT(needed, testing::UnorderedElementsAreArray(plan.Prerequisites(graph.task(index))));
  }
  for (std::size_t gop = 0; gop < 3; ++gop)
    EXPECT_EQ(plan.GopOf(graph.task(graph.GopBegin(gop)).frame), static_cast<int>(gop));
}

TEST(TaskGraph, ReadsEachArtifactOnce) {
  const JobPlan plan(MakeSizedJob({.frames = 3, .gop = 3, .views = 2, .blocks_i = 1}));
  const CostModel model(plan.resolved());
  const TaskGraph graph(plan, model);
  const auto read = [&](const TaskId& id) {
    for (TaskGraph::Index index = 0; index < graph.size(); ++index)
      if (graph.task(index) == id) return graph.BytesRead(index);
    return std::uint64_t{0};
  };
  const TaskId analysis{JobId(1), 0, TaskKind::kAnalyse, 0, 0};
  const std::uint64_t analyses = 2 * model.Of(analysis).result_bytes;
  EXPECT_EQ(read(analysis), 0U);
  EXPECT_EQ(read({JobId(1), 0, TaskKind::kEstimate, 0, 0}), analyses);
  // Of the first P frame the frame before is the I frame.
  const std::uint64_t labels = model.Of({JobId(1), 0, TaskKind::kEstimate, 0, 0}).result_bytes;
  EXPECT_EQ(read({JobId(1), 1, TaskKind::kEstimate, 0, 0}), 2 * analyses + labels);
  EXPECT_GT(read({JobId(1), 2, TaskKind::kEstimate, 0, 0}), 3 * analyses);
}

TEST(CriticalPath, OfAnIFrameGoesThroughEveryStageOnce) {
  const JobPlan plan(MakeSizedJob({.frames = 1, .views = 2, .blocks_i = 3}));
  const CostModel model(plan.resolved());
  const TaskGraph graph(plan, model);
  const CriticalPath path = FindCriticalPath(graph);
  std::vector<TaskKind> kinds;
  double seconds = 0;
  for (const TaskGraph::Index index : path.tasks) {
    kinds.push_back(graph.task(index).kind);
    seconds += graph.cost(index).seconds;
  }
  EXPECT_THAT(kinds, testing::ElementsAre(TaskKind::kAnalyse, TaskKind::kEstimate, TaskKind::kMerge, TaskKind::kMerge,
                                          TaskKind::kEmit, TaskKind::kCommit, TaskKind::kManifest));
  EXPECT_DOUBLE_EQ(path.seconds, seconds);
}

TEST(CriticalPath, EachTaskNeedsTheOneBefore) {
  const JobPlan plan(MakeSizedJob({.frames = 6, .gop = 4, .views = 3, .blocks_i = 2, .refine = 3, .confidence = true}));
  const CostModel model(plan.resolved());
  const TaskGraph graph(plan, model);
  const CriticalPath path = FindCriticalPath(graph);
  ASSERT_GT(path.tasks.size(), 4U);
  EXPECT_TRUE(graph.Needs(path.tasks.front()).empty());
  for (std::size_t i = 1; i < path.tasks.size(); ++i)
    EXPECT_THAT(graph.Needs(path.tasks[i]), testing::Contains(path.tasks[i - 1]));
  EXPECT_EQ(graph.task(path.tasks[path.tasks.size() - 2]).frame, 3) << "the end of the longer GOP";
}

}  // namespace
}  // namespace depthfarm
