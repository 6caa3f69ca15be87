#include "coordinator/service/task_filter.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

bool Matches(std::string_view text, const TaskId& task) { return TaskFilter::Parse(text).value().Matches(task); }

constexpr TaskId kEstimate{JobId(7), 3, TaskKind::kEstimate, 12, 0};
constexpr TaskId kMerge{JobId(7), 3, TaskKind::kMerge, 1, 2};
constexpr TaskId kRender{JobId(7), 3, TaskKind::kRender, 0, 0};

TEST(TaskFilter, TakesNamesAsStatusPrintsThem) {
  EXPECT_TRUE(Matches("frame 3 estimate block 12", kEstimate));
  EXPECT_TRUE(Matches("job 7 frame 3 estimate block 12", kEstimate));
  EXPECT_TRUE(Matches("frame 3 merge round 1 pair 2", kMerge));
  EXPECT_TRUE(Matches("render part 3", kRender));
  EXPECT_FALSE(Matches("frame 3 estimate block 1", kEstimate));
  EXPECT_FALSE(Matches("frame 3 merge round 2 pair 1", kMerge));
}

TEST(TaskFilter, TakesPartsOfNamesInAnyOrder) {
  EXPECT_TRUE(Matches("estimate frame 3 block 12", kEstimate));
  EXPECT_TRUE(Matches("  frame   3 ", kEstimate));
  EXPECT_TRUE(Matches("merge", kMerge));
  EXPECT_TRUE(Matches("", kMerge));
  EXPECT_FALSE(Matches("merge", kEstimate));
  EXPECT_FALSE(Matches("frame 33", kEstimate));
}

TEST(TaskFilter, RefusesWhatNamesNoTask) {
  for (const char* text : {"estimates", "frame", "3", "merge 4", "frame x", "frame 3 4"}) {
    EXPECT_EQ(TaskFilter::Parse(text).status().code(), ErrorCode::kInvalidArgument) << text;
  }
  EXPECT_FALSE(TaskFilter::Parse(std::string(1000, ' ')).ok());
}

}  // namespace
}  // namespace depthfarm
