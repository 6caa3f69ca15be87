#include "common/job/task.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace depthfarm {
namespace {

constexpr TaskKind kAllKinds[] = {TaskKind::kPrepare, TaskKind::kAnalyse,  TaskKind::kEstimate,
                                  TaskKind::kMerge,   TaskKind::kRefine,   TaskKind::kEmit,
                                  TaskKind::kCommit,  TaskKind::kManifest, TaskKind::kCleanup};

TEST(TaskKindName, IsAWordOfItsOwnForEveryKind) {
  std::set<std::string> names;
  for (const TaskKind kind : kAllKinds) names.insert(TaskKindName(kind));
  EXPECT_EQ(names, (std::set<std::string>{"prepare", "analyse", "estimate", "merge", "refine", "emit", "commit",
                                          "manifest", "cleanup"}));
  EXPECT_EQ(TaskKindName(static_cast<TaskKind>(99)), "unknown");
}

TEST(TaskName, SaysWhatTheTaskIsOf) {
  const auto name = [](TaskKind kind) { return TaskName({JobId(3), 12, kind, 1, 4}); };
  EXPECT_EQ(name(TaskKind::kPrepare), "job 3 prepare");
  EXPECT_EQ(name(TaskKind::kAnalyse), "job 3 frame 12 analyse view 1");
  EXPECT_EQ(name(TaskKind::kEstimate), "job 3 frame 12 estimate block 1");
  EXPECT_EQ(name(TaskKind::kMerge), "job 3 frame 12 merge round 1 pair 4");
  EXPECT_EQ(name(TaskKind::kRefine), "job 3 frame 12 refine round 1 view 4");
  EXPECT_EQ(name(TaskKind::kEmit), "job 3 frame 12 emit");
  EXPECT_EQ(name(TaskKind::kCommit), "job 3 frame 12 commit");
  EXPECT_EQ(name(TaskKind::kManifest), "job 3 manifest");
  EXPECT_EQ(name(TaskKind::kCleanup), "job 3 cleanup");
}

TEST(TaskId, EveryPartTellsTasksApart) {
  const TaskId id{JobId(3), 12, TaskKind::kMerge, 1, 4};
  std::set<TaskId> ids = {id,
                          {JobId(4), 12, TaskKind::kMerge, 1, 4},
                          {JobId(3), 13, TaskKind::kMerge, 1, 4},
                          {JobId(3), 12, TaskKind::kEmit, 1, 4},
                          {JobId(3), 12, TaskKind::kMerge, 2, 4},
                          {JobId(3), 12, TaskKind::kMerge, 1, 5}};
  EXPECT_EQ(ids.size(), 6u);
  ids.insert(id);
  EXPECT_EQ(ids.size(), 6u);
}

}  // namespace
}  // namespace depthfarm
