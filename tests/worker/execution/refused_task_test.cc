// Tasks that cannot be done, and what they say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "common/digest/sha256.h"
#include "tests/worker/execution/small_job.h"
#include "worker/estimation/label_field_codec.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

TEST(RefusedTask, NamesEveryMissingInput) {
  SmallJob job;
  TestWorker holder;
  ASSERT_TRUE(AnalyseFirstFrame(job, holder).ok());
  TestWorker stranger;
  const TaskSpec spec = job.Estimate(0, 0);
  const TaskOutcome outcome = stranger.Execute(spec, job.config);
  EXPECT_EQ(outcome.status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(outcome.status.message(), HasSubstr("frame 5"));
  EXPECT_EQ(outcome.missing_inputs, (std::vector<ArtifactKey>{spec.inputs[0].artifact.key, spec.inputs[1].artifact.key,
                                                              spec.inputs[2].artifact.key}));
}

TEST(RefusedTask, AStoppedTaskIsCancelledAndMakesNothing) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(AnalyseFirstFrame(job, worker).ok());
  std::stop_source stop;
  stop.request_stop();
  for (const TaskSpec& spec : {job.Analyse(1, 0), job.Estimate(0, 0)}) {
    const TaskOutcome outcome = worker.executor.Execute(spec, job.config, stop.get_token());
    EXPECT_EQ(outcome.status.code(), ErrorCode::kCancelled) << TaskName(spec.id);
    EXPECT_FALSE(outcome.artifact.has_value());
  }
}

TEST(RefusedTask, RefusesAJobOfAnotherAlgorithmVersion) {
  SmallJob job;
  TestWorker worker;
  job.config.algorithm_version = kAlgorithmVersion + 1;
  EXPECT_EQ(worker.Execute(job.Analyse(0, 0), job.config).status.code(), ErrorCode::kIncompatible);
}

TEST(RefusedTask, RefusesTasksThatDoNotFitTheJob) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(AnalyseFirstFrame(job, worker).ok());
  const auto code_of = [&](const TaskSpec& spec) { return worker.Execute(spec, job.config).status.code(); };
  TaskSpec spec = job.Analyse(0, 0);
  spec.id.index = 3;
  EXPECT_EQ(code_of(spec), ErrorCode::kInvalidArgument);
  spec = job.Analyse(0, 0);
  spec.id.frame = 2;
  EXPECT_EQ(code_of(spec), ErrorCode::kInvalidArgument);
  spec = job.Estimate(0, 0);
  spec.id.index = 2;
  EXPECT_EQ(code_of(spec), ErrorCode::kInvalidArgument);
  spec = job.Estimate(0, 0);
  spec.inputs.pop_back();
  EXPECT_EQ(code_of(spec), ErrorCode::kInvalidArgument);
  spec = job.Estimate(0, 0);
  spec.inputs[2].view = 1;
  EXPECT_EQ(code_of(spec), ErrorCode::kInvalidArgument);
  spec = job.Estimate(0, 0);
  spec.inputs[2].view = 3;
  EXPECT_EQ(code_of(spec), ErrorCode::kInvalidArgument);
}

TEST(RefusedTask, EstimatesOrRendersAsTheJobSays) {
  SmallJob job;
  TestWorker worker;
  TaskSpec render;
  render.id = {job.config.job, 0, TaskKind::kRender, 0, 0};
  render.staging = "part-0";
  const Status not_rendering = worker.Execute(render, job.config).status;
  EXPECT_EQ(not_rendering.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(not_rendering.message(), HasSubstr("the job estimates depth"));
  job.config.render = RenderSource{"/nowhere", {}};
  job.config.resolved = PartsOnly(1);
  const Status not_estimating = worker.Execute(job.Analyse(0, 0), job.config).status;
  EXPECT_EQ(not_estimating.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(not_estimating.message(), HasSubstr("the job renders views"));
  EXPECT_THAT(worker.Execute(render, job.config).status.message(), HasSubstr("/nowhere"));
}

TEST(RefusedTask, RefusesRefinementsThatDoNotFitTheJob) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  int made = 0;
  const auto status_of = [&](TaskSpec spec) {
    spec.output_key = Sha256("not made yet " + std::to_string(++made));
    return worker.Execute(spec, job.config).status;
  };
  EXPECT_TRUE(status_of(job.Refine(1, 1, 0)).ok());
  TaskSpec spec = job.Refine(1, 2, 0);
  spec.id.index = 3;
  EXPECT_THAT(status_of(spec).message(), HasSubstr("a round up to 2"));
  spec = job.Refine(1, 2, 0);
  spec.id.pair = 3;
  EXPECT_THAT(status_of(spec).message(), HasSubstr("a view below 3"));
  spec = job.Refine(1, 2, 0);
  spec.inputs.pop_back();
  EXPECT_THAT(status_of(spec).message(), HasSubstr("camera 'cam2' has no analysis or no refined depth"));
  spec = job.Refine(1, 0, 1);
  spec.inputs.pop_back();
  EXPECT_THAT(status_of(spec).message(), HasSubstr("the frames it refers to"));
  spec = job.Refine(1, 0, 1);
  spec.inputs[5].view = 7;
  EXPECT_EQ(status_of(spec).code(), ErrorCode::kInvalidArgument);
}

TEST(RefusedTask, EmitsRefinedDepthOfEveryViewOrNone) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  ASSERT_TRUE(worker.Execute(job.Simple(TaskKind::kPrepare), job.config).status.ok());
  TaskSpec spec = job.Emit(1);
  EXPECT_TRUE(worker.Execute(spec, job.config).status.ok());
  spec.inputs.erase(spec.inputs.begin() + 1);
  const Status status = worker.Execute(spec, job.config).status;
  EXPECT_THAT(status.message(), HasSubstr("frame 6: camera 'cam1' has no refined depth"));
}

TEST(RefusedTask, EmitsNoDepthFromLabelsThatDoNotFit) {
  SmallJob job;
  job.config.resolved.params.refine_rounds = 0;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  ASSERT_TRUE(worker.Execute(job.Simple(TaskKind::kPrepare), job.config).status.ok());
  TaskSpec spec = job.Emit(0);
  LabelField field = DecodeLabelField(worker.store->Get(spec.inputs[3].artifact.key).value()).value();
  const auto emit_with = [&](const LabelField& labels, int number) {
    ArtifactKey key{};
    key[0] = static_cast<std::uint8_t>(number);
    spec.inputs[3].artifact = worker.store->Put(key, EncodeLabelField(labels)).value();
    return worker.Execute(spec, job.config).status;
  };
  EXPECT_TRUE(emit_with(field, 1).ok());
  LabelField bad = field;
  bad.views[1].levels[7] = 8;  // the job has levels 0 to 7
  EXPECT_THAT(emit_with(bad, 2).message(), HasSubstr("camera 'cam1' contain level 8 of 8"));
  bad = field;
  bad.views[2].levels.pop_back();
  bad.views[2].unchanged.pop_back();
  EXPECT_EQ(emit_with(bad, 3).code(), ErrorCode::kInvalidArgument);
  bad = field;
  bad.views.pop_back();
  EXPECT_EQ(emit_with(bad, 4).code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
