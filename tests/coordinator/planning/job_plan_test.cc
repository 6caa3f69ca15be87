#include "coordinator/planning/job_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/coordinator/planned_job.h"

namespace depthfarm {
namespace {

TaskId Id(TaskKind kind, int frame, int index = 0, int pair = 0) { return {JobId(1), frame, kind, index, pair}; }

std::vector<TaskId> LabelInputs(const JobPlan& plan, const TaskId& id) {
  std::vector<TaskId> labels;
  for (const PlannedInput& input : plan.Inputs(id)) {
    if (input.role == InputRole::kLabels) labels.push_back(input.producer);
  }
  return labels;
}

TEST(MergePlan, FiveBlocksNeedThreeRounds) {  // ceil(log2 5), IV-A
  const JobPlan plan(MakePlannedJob({.frames = 1, .blocks_i = 5}));
  std::vector<TaskId> merges;
  for (const TaskId& id : plan.TasksOfGop(0)) {
    if (id.kind == TaskKind::kMerge) merges.push_back(id);
  }
  EXPECT_THAT(merges, testing::ElementsAre(Id(TaskKind::kMerge, 0, 0, 0), Id(TaskKind::kMerge, 0, 0, 1),
                                           Id(TaskKind::kMerge, 0, 1, 0), Id(TaskKind::kMerge, 0, 2, 0)));
}

TEST(MergePlan, TheOddOnePassesOnWithoutATask) {
  const JobPlan plan(MakePlannedJob({.frames = 1, .blocks_i = 5}));
  // Rounds of 5, 3, 2: block 4 passes rounds 0 and 1 and meets the rest in round 2.
  EXPECT_THAT(LabelInputs(plan, Id(TaskKind::kMerge, 0, 2, 0)),
              testing::ElementsAre(Id(TaskKind::kMerge, 0, 1, 0), Id(TaskKind::kEstimate, 0, 4)));
  EXPECT_EQ(plan.FinalLabels(0), Id(TaskKind::kMerge, 0, 2, 0));
}

TEST(MergePlan, EveryBlockReachesTheFinalLabelsOnce) {
  for (int blocks = 1; blocks <= 33; ++blocks) {
    const JobPlan plan(MakePlannedJob({.frames = 1, .blocks_i = blocks}));
    std::multiset<int> reached;
    std::vector<TaskId> open = {plan.FinalLabels(0)};
    while (!open.empty()) {
      const TaskId id = open.back();
      open.pop_back();
      if (id.kind == TaskKind::kEstimate) reached.insert(id.index);
      for (const TaskId& input : LabelInputs(plan, id)) open.push_back(input);
    }
    ASSERT_EQ(static_cast<int>(reached.size()), blocks);
    ASSERT_EQ(std::set<int>(reached.begin(), reached.end()).size(), reached.size());
  }
}

TEST(JobPlan, AnIFrameReadsItsOwnAnalysesOnly) {
  const JobPlan plan(MakePlannedJob({.frames = 4, .gop = 2}));
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kEstimate, 2, 1)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 2, 0), InputRole::kAnalysis, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 2, 1), InputRole::kAnalysis, 1}));
}

TEST(JobPlan, APFrameReadsThePreviousFrameAndTheIFrameByRoleThenView) {
  const JobPlan plan(MakePlannedJob({.frames = 6, .gop = 3, .blocks_i = 2, .blocks_p = 1}));
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kEstimate, 5)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 5, 0), InputRole::kAnalysis, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 5, 1), InputRole::kAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kAnalyse, 4, 0), InputRole::kPreviousAnalysis, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 4, 1), InputRole::kPreviousAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kEstimate, 4, 0), InputRole::kPreviousLabels, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 3, 0), InputRole::kIAnalysis, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 3, 1), InputRole::kIAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kMerge, 3, 0, 0), InputRole::kILabels, 0}));
}

TEST(JobPlan, TheFirstPFrameListsTheIFrameInBothRoles) {
  const JobPlan plan(MakePlannedJob({.frames = 2, .gop = 2, .blocks_i = 1}));
  const std::vector<PlannedInput> inputs = plan.Inputs(Id(TaskKind::kEstimate, 1));
  EXPECT_EQ(inputs.size(), 8U);
  EXPECT_EQ(plan.Prerequisites(Id(TaskKind::kEstimate, 1)).size(), 5U);  // each task once
}

TEST(RefinePlan, StartsFromTheLabelsAndOfAPFrameFromTheRefinedFramesItRefersTo) {
  const JobPlan plan(MakePlannedJob({.frames = 6, .gop = 3, .views = 3, .blocks_i = 1, .refine = 2}));
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kRefine, 3, 0, 1)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 3, 1), InputRole::kAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kEstimate, 3, 0), InputRole::kLabels, 0}));
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kRefine, 5, 0, 1)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 5, 1), InputRole::kAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kAnalyse, 4, 1), InputRole::kPreviousAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kAnalyse, 3, 1), InputRole::kIAnalysis, 1},
                                   PlannedInput{Id(TaskKind::kEstimate, 5, 0), InputRole::kLabels, 0},
                                   PlannedInput{Id(TaskKind::kRefine, 4, 2, 1), InputRole::kPreviousRefined, 1},
                                   PlannedInput{Id(TaskKind::kRefine, 3, 2, 1), InputRole::kIRefined, 1}));
}

TEST(RefinePlan, ARoundReadsTheRoundBeforeOfTheViewAndThoseItIsComparedWith) {
  const JobPlan plan(MakePlannedJob({.frames = 1, .views = 4, .refine = 2}));  // view 3 is compared with view 0
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kRefine, 0, 2, 3)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 0, 0), InputRole::kAnalysis, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 0, 3), InputRole::kAnalysis, 3},
                                   PlannedInput{Id(TaskKind::kRefine, 0, 1, 0), InputRole::kRefined, 0},
                                   PlannedInput{Id(TaskKind::kRefine, 0, 1, 3), InputRole::kRefined, 3}));
}

TEST(JobPlan, AnalysesOfPFramesFollowOneAnother) {
  const JobPlan plan(MakePlannedJob({.frames = 6, .gop = 3, .views = 2}));
  EXPECT_TRUE(plan.Inputs(Id(TaskKind::kAnalyse, 3, 1)).empty());
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kAnalyse, 5, 1)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 4, 1), InputRole::kPreviousAnalysis, 1}));
}

TEST(JobPlan, WithASharedAnchorAGopBeginsWithAPFrameThatReadsTheFirstFrameAlone) {
  const JobPlan plan(MakePlannedJob({.frames = 9, .gop = 3, .views = 2, .refine = 3, .anchor = Anchor::kShared}));
  std::vector<PlannedInput> inputs;
  for (const TaskId& id : plan.TasksOfGop(2)) {
    if (id.frame != 6) continue;
    for (const PlannedInput& input : plan.Inputs(id)) {
      if (input.producer.frame == 6) continue;
      EXPECT_EQ(input.producer.frame, 0);
      const std::vector<TaskId> shared = plan.SharedByGops();
      EXPECT_NE(std::ranges::find(shared, input.producer), shared.end()) << TaskName(input.producer);
      inputs.push_back(input);
    }
  }
  // Analyse 2 views x 1; Estimate 2 x 2 analyses and 2 x labels; Refine 2 views x (2 analyses, 2 refined).
  EXPECT_EQ(inputs.size(), 2U + 6U + 8U);
  EXPECT_EQ(plan.Inputs({JobId(1), 7, TaskKind::kAnalyse, 1, 0}).at(0).producer.frame, 6);
  EXPECT_EQ(plan.Total(TaskKind::kEstimate), 2U + 8U);
}

TEST(RefinePlan, APFrameDoesTheLastTwoRoundsAlone) {
  const JobPlan plan(MakePlannedJob({.frames = 2, .gop = 2, .views = 2, .refine = 4}));
  const auto rounds_of = [&](int frame) {
    std::set<int> rounds;
    for (const TaskId& id : plan.TasksOfGop(0))
      if (id.kind == TaskKind::kRefine && id.frame == frame) rounds.insert(id.index);
    return rounds;
  };
  EXPECT_EQ(rounds_of(0), (std::set<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(rounds_of(1), (std::set<int>{0, 3, 4}));
  EXPECT_EQ(plan.Total(TaskKind::kRefine), 2U * (5 + 3));
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kRefine, 1, 3, 0)),
              testing::Contains(PlannedInput{Id(TaskKind::kRefine, 1, 0, 0), InputRole::kRefined, 0}));
  EXPECT_THAT(plan.Inputs(Id(TaskKind::kRefine, 1, 4, 0)),
              testing::Contains(PlannedInput{Id(TaskKind::kRefine, 1, 3, 0), InputRole::kRefined, 0}));
}

TEST(RefinePlan, EmitReadsTheLastRoundOfEveryViewAndLabelsWithoutRefinement) {
  const JobPlan refined(MakePlannedJob({.frames = 1, .refine = 3}));
  EXPECT_THAT(refined.Inputs(Id(TaskKind::kEmit, 0)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kRefine, 0, 3, 0), InputRole::kRefined, 0},
                                   PlannedInput{Id(TaskKind::kRefine, 0, 3, 1), InputRole::kRefined, 1}));
  const JobPlan levels(MakePlannedJob({.frames = 1, .refine = 0}));
  EXPECT_THAT(LabelInputs(levels, Id(TaskKind::kEmit, 0)), testing::ElementsAre(levels.FinalLabels(0)));
}

TEST(ConfidencePlan, IsJudgedByTheLastRoundOfTheViewAndThoseItIsComparedWith) {
  const JobPlan plan(MakePlannedJob({.frames = 1, .views = 4, .refine = 2, .confidence = true}));
  EXPECT_THAT(plan.Inputs(plan.Assessed(0, 3)),
              testing::ElementsAre(PlannedInput{Id(TaskKind::kAnalyse, 0, 0), InputRole::kAnalysis, 0},
                                   PlannedInput{Id(TaskKind::kAnalyse, 0, 3), InputRole::kAnalysis, 3},
                                   PlannedInput{Id(TaskKind::kRefine, 0, 2, 0), InputRole::kRefined, 0},
                                   PlannedInput{Id(TaskKind::kRefine, 0, 2, 3), InputRole::kRefined, 3}));
}

TEST(ConfidencePlan, IsEmittedBesideTheDepthOrMakesHolesInIt) {
  PlannedJob job = MakePlannedJob({.frames = 1, .refine = 1, .confidence = true});
  const auto inputs = [&] { return JobPlan(job).Inputs(Id(TaskKind::kEmit, 0)); };
  EXPECT_THAT(inputs(), testing::ElementsAre(PlannedInput{Id(TaskKind::kRefine, 0, 1, 0), InputRole::kRefined, 0},
                                             PlannedInput{Id(TaskKind::kRefine, 0, 1, 1), InputRole::kRefined, 1},
                                             PlannedInput{Id(TaskKind::kAssess, 0, 0), InputRole::kConfidence, 0},
                                             PlannedInput{Id(TaskKind::kAssess, 0, 1), InputRole::kConfidence, 1}));
  EXPECT_THAT(JobPlan(job).OutputPaths(0),
              testing::ElementsAre("depth/cam0/0000.png", "depth/cam1/0000.png", "confidence/cam0/0000.png",
                                   "confidence/cam1/0000.png"));
  job.config.resolved.params.output_format = DepthFormat::kExr;
  EXPECT_EQ(JobPlan(job).OutputPaths(0)[1], "depth/cam1/0000.exr");
  EXPECT_EQ(JobPlan(job).OutputPaths(0)[2], "confidence/cam0/0000.png");
  job.config.resolved.params.confidence = false;
  EXPECT_EQ(inputs().size(), 2U);
  job.config.resolved.params.holes = 0.5;
  EXPECT_EQ(inputs().size(), 4U);
  EXPECT_EQ(JobPlan(job).OutputPaths(0).size(), 2U);
}

TEST(JobPlan, EmitWaitsForPrepareAndCommitForEmit) {
  const JobPlan plan(MakePlannedJob({}));
  EXPECT_THAT(plan.Prerequisites(Id(TaskKind::kEmit, 1)), testing::Contains(plan.OfJob(TaskKind::kPrepare)));
  EXPECT_THAT(plan.Prerequisites(Id(TaskKind::kCommit, 1)), testing::ElementsAre(Id(TaskKind::kEmit, 1)));
}

TEST(JobPlan, TotalsCountWhatTheGopsHoldAndPrerequisitesComeFirst) {
  for (const JobShape& shape : {JobShape{.frames = 7, .gop = 3, .views = 3, .blocks_i = 5, .blocks_p = 2},
                                JobShape{.frames = 1, .gop = 10, .views = 2, .blocks_i = 1, .blocks_p = 1},
                                JobShape{.frames = 4, .gop = 1, .views = 4, .blocks_i = 8, .blocks_p = 2},
                                JobShape{.frames = 5, .gop = 3, .views = 3, .blocks_i = 2, .refine = 2},
                                JobShape{.frames = 5, .gop = 3, .views = 3, .refine = 4},
                                JobShape{.frames = 5, .gop = 3, .views = 3, .refine = 1, .confidence = true}}) {
    const JobPlan plan(MakePlannedJob(shape));
    std::map<TaskKind, std::uint64_t> counts;
    for (int gop = 0; gop < plan.num_gops(); ++gop) {
      std::set<TaskId> seen = {plan.OfJob(TaskKind::kPrepare)};
      for (const TaskId& id : plan.TasksOfGop(gop)) {
        ++counts[id.kind];
        for (const TaskId& needed : plan.Prerequisites(id)) ASSERT_TRUE(seen.contains(needed)) << TaskName(id);
        ASSERT_TRUE(seen.insert(id).second);
      }
    }
    for (const auto& [kind, count] : counts) EXPECT_EQ(count, plan.Total(kind)) << TaskKindName(kind);
  }
}

TEST(JobPlan, OutputIsNumberedByTheSequence) {
  PlannedJob job = MakePlannedJob({});
  job.config.resolved.params.first_frame = 9998;
  const JobPlan plan(job);
  EXPECT_THAT(plan.OutputPaths(1), testing::ElementsAre("depth/cam0/9999.png", "depth/cam1/9999.png"));
  EXPECT_THAT(plan.OutputPaths(2), testing::ElementsAre("depth/cam0/10000.png", "depth/cam1/10000.png"));
}

TEST(JobPlan, ARenderingJobIsPartsOfEightViews) {
  const JobPlan plan(MakeRenderingJob(1, 17));
  EXPECT_EQ(plan.num_gops(), 3);
  EXPECT_THAT(plan.TasksOfGop(2), testing::ElementsAre(Id(TaskKind::kRender, 2), Id(TaskKind::kCommit, 2)));
  EXPECT_THAT(plan.Prerequisites(Id(TaskKind::kRender, 2)), testing::ElementsAre(plan.OfJob(TaskKind::kPrepare)));
  EXPECT_THAT(plan.Prerequisites(Id(TaskKind::kCommit, 2)), testing::ElementsAre(Id(TaskKind::kRender, 2)));
  EXPECT_EQ(plan.ViewsOf(1).front().number, 8);
  EXPECT_EQ(plan.ViewsOf(1).size(), 8U);
  EXPECT_THAT(plan.OutputPaths(2), testing::ElementsAre("views/0016.png"));
  std::uint64_t total = 0;
  for (int kind = 0; kind < kNumTaskKinds; ++kind) total += plan.Total(static_cast<TaskKind>(kind));
  EXPECT_EQ(total, 3U + 3U + 2U);  // Render, Commit; Prepare, Manifest
}

TEST(JobPlan, AJobTooLongForItsManifestIsRefused) {
  EXPECT_TRUE(CheckPlannable(MakePlannedJob({}).config.resolved).ok());
  ResolvedJob job = MakePlannedJob({}).config.resolved;
  job.num_frames = 200'001;
  EXPECT_EQ(CheckPlannable(job).code(), ErrorCode::kInvalidArgument);
  job.num_frames = 100'001;
  EXPECT_TRUE(CheckPlannable(job).ok());
  job.params.confidence = true;
  EXPECT_EQ(CheckPlannable(job).code(), ErrorCode::kInvalidArgument);
}

TEST(JobPlan, AGopTooLargeForMemoryIsRefused) {
  ResolvedJob job = MakePlannedJob({.frames = 8'000, .views = 2, .refine = 4}).config.resolved;
  EXPECT_TRUE(CheckPlannable(job).ok());
  job.params.gop = job.num_frames;
  EXPECT_THAT(CheckPlannable(job).message(), testing::HasSubstr("choose a smaller --gop"));
}

}  // namespace
}  // namespace depthfarm
