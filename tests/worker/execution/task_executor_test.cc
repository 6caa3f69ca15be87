#include "worker/execution/task_executor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/files/file_bundle.h"
#include "common/media/depth_file.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "common/sequence/depth_manifest.h"
#include "tests/worker/execution/small_job.h"
#include "worker/estimation/label_field_codec.h"
#include "worker/execution/analysis_key.h"
#include "worker/segmentation/analysis_codec.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

// Relative path -> content of every file below a folder.
std::map<std::string, std::string> Contents(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    contents[fs::relative(entry.path(), folder).string()] =
        ReadFileBytes(entry.path().string(), std::uint64_t{1} << 30).value();
  }
  return contents;
}

// All views of the I frame are analysed.
void AnalyseFirstFrame(SmallJob& job, TestWorker& worker) {
  for (int view = 0; view < 3; ++view) {
    const TaskSpec spec = job.Analyse(0, view);
    const TaskOutcome outcome = worker.Execute(spec, job.config);
    ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
    job.Note(spec, outcome);
  }
}

TEST(TaskExecutor, RunsAWholeJob) {
  SmallJob job;
  TestWorker worker;
  const Status status = job.RunOn({&worker});
  ASSERT_TRUE(status.ok()) << status.message();

  const DepthManifest manifest = ReadDepthManifest(job.output().string()).value();
  EXPECT_EQ(manifest.first_frame, 5);
  ASSERT_THAT(manifest.cameras, SizeIs(3));
  for (const DepthManifestCamera& camera : manifest.cameras) {
    ASSERT_THAT(camera.files, SizeIs(2));
    EXPECT_EQ(camera.files[1].path, "depth/" + camera.camera.name + "/0006.png");
    for (const DepthManifestFile& file : camera.files) {
      const std::string bytes = ReadFileBytes((job.output() / file.path).string(), 1 << 20).value();
      EXPECT_EQ(Hex(Sha256(bytes)), file.sha256);
      const Grid<std::uint16_t> codes = DecodeDepthPng(bytes).value();
      EXPECT_EQ(codes.width(), camera.camera.width);
      EXPECT_EQ(codes.height(), camera.camera.height);
    }
  }
  EXPECT_EQ(manifest.cameras[2].input_sha256[1],
            Hex(Sha256(ReadFileBytes(job.picture(1, 2).string(), 1 << 20).value())));
  EXPECT_FALSE(fs::exists(job.output() / ".depthfarm-staging"));
  EXPECT_FALSE(fs::exists(job.output() / ".depthfarm-job"));
}

// Refined depth and confidence of version 9, as this code made them first (g++ 12, x86-64): who changes them raises
// kAlgorithmVersion, and then this digest.
TEST(TaskExecutor, DepthAndConfidenceAreThoseOfTheAlgorithmVersion) {
  constexpr const char* kPictures = "99da935a5c3dd127c7c33557f769a46cab0565262167c3a32cff805c26e8883a";
  constexpr const char* kMaps = "4b5a18b7d137c3baaca1b77719058c6837dadfbee90c338556277eca29c2c7b0";
  SmallJob job;
  job.config.resolved.params.confidence = true;
  std::string pictures;
  for (int frame = 0; frame < 2; ++frame)
    for (int view = 0; view < 3; ++view) pictures += ReadFileBytes(job.picture(frame, view).string(), 1 << 20).value();
  if (Hex(Sha256(pictures)) != kPictures) GTEST_SKIP() << "another sine gave other pictures";
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  std::string codes;  // not the files: their bytes are also those of libpng and zlib
  for (const auto& [name, bytes] : Contents(job.output())) {
    if (!name.ends_with(".png")) continue;
    const Grid<std::uint16_t> map = DecodeDepthPng(bytes).value();
    for (const std::uint16_t code : map.values()) {
      codes.push_back(static_cast<char>(code & 0xFFU));
      codes.push_back(static_cast<char>(code >> 8U));
    }
  }
  EXPECT_EQ(kAlgorithmVersion, 10U);
  EXPECT_EQ(Hex(Sha256(codes)), kMaps);
}

TEST(TaskExecutor, TheResultDoesNotDependOnTheNumberOfWorkers) {
  SmallJob alone;
  TestWorker worker;
  ASSERT_TRUE(alone.RunOn({&worker}).ok());

  SmallJob shared;
  TestWorker a;
  TestWorker b;
  a.fetcher.stores = b.fetcher.stores = {a.store.get(), b.store.get()};
  const Status status = shared.RunOn({&a, &b});
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_GT(a.fetcher.fetches, 0);
  EXPECT_GT(b.fetcher.fetches, 0);
  EXPECT_EQ(Contents(shared.output()), Contents(alone.output()));
}

TEST(TaskExecutor, TheResultDoesNotDependOnTheNumberOfThreads) {
  SmallJob alone;
  TestWorker worker;
  ASSERT_TRUE(alone.RunOn({&worker}).ok());
  for (const int threads : {2, 3, 5}) {
    SmallJob shared;
    TestWorker other(threads);
    const Status status = shared.RunOn({&other});
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(Contents(shared.output()), Contents(alone.output())) << threads << " threads";
  }
}

TEST(TaskExecutor, ConfidenceIsWrittenBesideTheSameDepthOrMakesHolesInIt) {
  SmallJob plain;
  TestWorker worker;
  ASSERT_TRUE(plain.RunOn({&worker}).ok());
  const auto depth = Contents(plain.output());

  SmallJob with;
  with.config.resolved.params.confidence = true;
  TestWorker second;
  ASSERT_TRUE(with.RunOn({&second}).ok());
  auto contents = Contents(with.output());
  const DepthManifest manifest = ReadDepthManifest(with.output().string()).value();
  constexpr double kLeast = 0.9;
  int doubtful = 0;
  SmallJob holed;
  holed.config.resolved.params.holes = kLeast;
  TestWorker third;
  ASSERT_TRUE(holed.RunOn({&third}).ok());
  const auto with_holes = Contents(holed.output());
  for (const DepthManifestCamera& camera : manifest.cameras) {
    ASSERT_THAT(camera.confidence, SizeIs(2));
    for (std::size_t frame = 0; frame < 2; ++frame) {
      const std::string& path = camera.files[frame].path;
      EXPECT_EQ(contents.at(path), depth.at(path)) << "confidence changes no depth";
      const std::string& confidence_path = camera.confidence[frame].path;
      EXPECT_EQ(confidence_path, "confidence/" + camera.camera.name + "/000" + std::to_string(5 + frame) + ".png");
      EXPECT_EQ(Hex(Sha256(contents.at(confidence_path))), camera.confidence[frame].sha256);
      const Grid<std::uint16_t> codes = DecodeDepthPng(depth.at(path)).value();
      const Grid<std::uint16_t> confidence = DecodeDepthPng(contents.at(confidence_path)).value();
      const Grid<std::uint16_t> left = DecodeDepthPng(with_holes.at(path)).value();
      for (std::size_t i = 0; i < codes.size(); ++i) {
        const bool is_doubtful = confidence.values()[i] < kLeast * 65535;
        ASSERT_EQ(left.values()[i], is_doubtful ? 0 : codes.values()[i]);
        doubtful += is_doubtful ? 1 : 0;
      }
    }
  }
  EXPECT_GT(doubtful, 0);
  EXPECT_FALSE(with_holes.contains("confidence/" + manifest.cameras[0].camera.name + "/0005.png"));
}

TEST(TaskExecutor, ARepeatedJobReusesWhatExists) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  for (const TaskSpec& spec :
       {job.Analyse(0, 1), job.Estimate(1, 0), job.Merge(1), job.Refine(1, 0, 2), job.Refine(1, 2, 1)}) {
    const TaskOutcome outcome = worker.Execute(spec, job.config);
    ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
    EXPECT_TRUE(outcome.stats.reused) << TaskName(spec.id);
    EXPECT_EQ(outcome.artifact, worker.store->Find(outcome.artifact->key));
  }
}

TEST(TaskExecutor, AnAnalysisThatAnotherWorkerHoldsIsFetchedNotMade) {
  SmallJob job;
  TestWorker first;
  TestWorker second;
  const TaskOutcome made = first.Execute(job.Analyse(0, 0), job.config);
  second.fetcher.stores = {first.store.get()};
  TaskSpec spec = job.Analyse(0, 0);
  spec.known = TaskInput{*made.artifact, InputRole::kAnalysis, 0, {}};
  const TaskOutcome outcome = second.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_TRUE(outcome.stats.reused);
  EXPECT_EQ(outcome.artifact, made.artifact);
  EXPECT_EQ(outcome.picture_digest, made.picture_digest);
  EXPECT_GT(outcome.stats.fetched_bytes, 0U);
}

TEST(TaskExecutor, AnAnalysisOfAPictureThatChangedIsMadeWhateverTheCoordinatorBelieves) {
  SmallJob job;
  TestWorker first;
  TestWorker second;
  const TaskOutcome made = first.Execute(job.Analyse(0, 0), job.config);
  second.fetcher.stores = {first.store.get()};
  TaskSpec spec = job.Analyse(0, 1);  // as if this were what the file holds now
  spec.known = TaskInput{*made.artifact, InputRole::kAnalysis, 0, {}};
  const TaskOutcome outcome = second.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_FALSE(outcome.stats.reused);
  EXPECT_NE(outcome.artifact->key, made.artifact->key);
  EXPECT_EQ(second.fetcher.fetches, 0);
}

TEST(TaskExecutor, AnAnalysisThatCannotBeFetchedIsMade) {
  SmallJob job;
  TestWorker first;
  TestWorker second;
  const TaskOutcome made = first.Execute(job.Analyse(0, 0), job.config);
  TaskSpec spec = job.Analyse(0, 0);
  spec.known = TaskInput{*made.artifact, InputRole::kAnalysis, 0, {}};
  const TaskOutcome outcome = second.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_FALSE(outcome.stats.reused);
  EXPECT_EQ(outcome.artifact, made.artifact);
  EXPECT_TRUE(outcome.missing_inputs.empty());
}

TEST(TaskExecutor, ADamagedArtifactIsMadeAgainNotReused) {
  SmallJob job;
  TestWorker worker;
  const TaskOutcome first = worker.Execute(job.Analyse(0, 0), job.config);
  ASSERT_TRUE(worker.store->Put(*first.output_key, "rubbish").ok());
  worker.cache.Erase(*first.output_key);
  const TaskOutcome second = worker.Execute(job.Analyse(0, 0), job.config);
  ASSERT_TRUE(second.status.ok()) << second.status.message();
  EXPECT_FALSE(second.stats.reused);
  EXPECT_EQ(second.artifact, first.artifact);
}

// A byte of the file of an artifact, in its place.
void Damage(const TestWorker& worker, const ArtifactKey& key) {
  for (const auto& entry : fs::recursive_directory_iterator(worker.folder.path())) {
    if (entry.path().filename() != Hex(key)) continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-1, std::ios::end).put('\x5a');
    ASSERT_TRUE(file.flush());
  }
}

TEST(TaskExecutor, WhatIsInMemoryDoesNotStandInForADamagedFile) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(job.RunOn({&worker}).ok());
  for (const TaskSpec& spec : {job.Analyse(0, 1), job.Estimate(1, 0), job.Refine(1, 0, 2)}) {
    const ArtifactInfo made = *worker.Execute(spec, job.config).artifact;
    Damage(worker, made.key);
    const TaskOutcome again = worker.Execute(spec, job.config);
    ASSERT_TRUE(again.status.ok()) << again.status.message();
    EXPECT_FALSE(again.stats.reused) << TaskName(spec.id);
    EXPECT_EQ(again.artifact, made);
    EXPECT_TRUE(worker.store->Get(made.key).ok()) << "what others are given";
  }
}

TEST(TaskExecutor, BlocksOfAFrameShareItsAnalysis) {
  SmallJob job;
  TestWorker holder;
  AnalyseFirstFrame(job, holder);
  TestWorker worker;
  worker.fetcher.stores = {holder.store.get()};
  const TaskOutcome first = worker.Execute(job.Estimate(0, 0), job.config);
  ASSERT_TRUE(first.status.ok()) << first.status.message();
  EXPECT_EQ(worker.fetcher.fetches, 3);
  EXPECT_GT(first.stats.fetched_bytes, 0);
  const TaskOutcome second = worker.Execute(job.Estimate(0, 1), job.config);
  ASSERT_TRUE(second.status.ok());
  EXPECT_EQ(worker.fetcher.fetches, 3);
  EXPECT_EQ(second.stats.fetched_bytes, 0);
}

TEST(TaskExecutor, UsesTheBytesTheJobNamesNotOthersOfTheSameKey) {
  SmallJob job;
  TestWorker holder;
  AnalyseFirstFrame(job, holder);
  const TaskSpec spec = job.Estimate(0, 0);
  TestWorker worker;
  worker.fetcher.stores = {holder.store.get()};
  const std::string other_view = holder.store->Get(spec.inputs[1].artifact.key).value();
  ASSERT_TRUE(worker.store->Put(spec.inputs[0].artifact.key, other_view).ok());
  const TaskOutcome outcome = worker.Execute(spec, job.config);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.message();
  EXPECT_EQ(outcome.artifact, holder.Execute(spec, job.config).artifact);
}

TEST(TaskExecutor, NamesEveryMissingInput) {
  SmallJob job;
  TestWorker holder;
  AnalyseFirstFrame(job, holder);
  TestWorker stranger;
  const TaskSpec spec = job.Estimate(0, 0);
  const TaskOutcome outcome = stranger.Execute(spec, job.config);
  EXPECT_EQ(outcome.status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(outcome.status.message(), HasSubstr("frame 5"));
  EXPECT_EQ(outcome.missing_inputs, (std::vector<ArtifactKey>{spec.inputs[0].artifact.key, spec.inputs[1].artifact.key,
                                                              spec.inputs[2].artifact.key}));
}

TEST(TaskExecutor, AnErrorOfAPictureNamesCameraFrameAndFile) {
  SmallJob job;
  TestWorker worker;
  AnalyseFirstFrame(job, worker);
  std::ofstream(job.picture(1, 2)) << "too short";
  const TaskOutcome outcome = worker.Execute(job.Analyse(1, 2), job.config);
  EXPECT_EQ(outcome.status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(outcome.status.message(), HasSubstr("camera 'cam2', frame 6"));
  EXPECT_THAT(outcome.status.message(), HasSubstr(job.picture(1, 2).string()));
}

TEST(TaskExecutor, AnAnalysisOfAPFrameIsGivenThatOfTheFrameBeforeAndNoOther) {
  SmallJob job;
  TestWorker worker;
  AnalyseFirstFrame(job, worker);
  TaskSpec alone = job.Analyse(1, 2);
  const std::vector<TaskInput> before = std::exchange(alone.inputs, {});
  EXPECT_EQ(worker.Execute(alone, job.config).status.code(), ErrorCode::kInvalidArgument);
  TaskSpec of_i_frame = job.Analyse(0, 2);
  of_i_frame.inputs = before;
  EXPECT_EQ(worker.Execute(of_i_frame, job.config).status.code(), ErrorCode::kInvalidArgument);
  TaskSpec of_another_view = job.Analyse(1, 1);
  of_another_view.inputs = before;
  EXPECT_EQ(worker.Execute(of_another_view, job.config).status.code(), ErrorCode::kInvalidArgument);
}

TEST(TaskExecutor, AMissingPictureMayBeReadableElsewhere) {
  SmallJob job;
  TestWorker worker;
  fs::remove(job.picture(0, 0));
  const TaskOutcome outcome = worker.Execute(job.Analyse(0, 0), job.config);
  EXPECT_EQ(outcome.status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(outcome.status.message(), HasSubstr("camera 'cam0', frame 5"));
}

TEST(TaskExecutor, AStoppedTaskIsCancelledAndMakesNothing) {
  SmallJob job;
  TestWorker worker;
  AnalyseFirstFrame(job, worker);
  std::stop_source stop;
  stop.request_stop();
  for (const TaskSpec& spec : {job.Analyse(1, 0), job.Estimate(0, 0)}) {
    const TaskOutcome outcome = worker.executor.Execute(spec, job.config, stop.get_token());
    EXPECT_EQ(outcome.status.code(), ErrorCode::kCancelled) << TaskName(spec.id);
    EXPECT_FALSE(outcome.artifact.has_value());
  }
}

TEST(TaskExecutor, RefusesAJobOfAnotherAlgorithmVersion) {
  SmallJob job;
  TestWorker worker;
  job.config.algorithm_version = kAlgorithmVersion + 1;
  EXPECT_EQ(worker.Execute(job.Analyse(0, 0), job.config).status.code(), ErrorCode::kIncompatible);
}

TEST(TaskExecutor, RefusesTasksThatDoNotFitTheJob) {
  SmallJob job;
  TestWorker worker;
  AnalyseFirstFrame(job, worker);
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

TEST(TaskExecutor, EstimatesOrRendersAsTheJobSays) {
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

TEST(TaskExecutor, RefusesRefinementsThatDoNotFitTheJob) {
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

TEST(TaskExecutor, EmitsRefinedDepthOfEveryViewOrNone) {
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

TEST(TaskExecutor, EmitsNoDepthFromLabelsThatDoNotFit) {
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

TEST(TaskExecutor, MeasuresWhatATaskCost) {
  SmallJob job;
  TestWorker worker;
  AnalyseFirstFrame(job, worker);
  const TaskStats stats = worker.Execute(job.Estimate(0, 0), job.config).stats;
  EXPECT_GT(stats.wall_seconds, 0);
  EXPECT_GE(stats.cpu_seconds, 0);
  EXPECT_GT(stats.peak_memory_bytes, 1 << 20);
  EXPECT_GT(stats.sweeps, 0);
  EXPECT_GT(stats.segments, 0);
  EXPECT_EQ(stats.nodes, stats.segments);  // an I frame adopts nothing
}

// What an analysis of the first picture holds, and its name.
std::pair<ViewAnalysis, ArtifactKey> AnalysisOf(const TaskSpec& spec, const JobConfig& config) {
  TestWorker worker;
  const TaskOutcome outcome = worker.Execute(spec, config);
  EXPECT_TRUE(outcome.status.ok()) << outcome.status.message();
  if (!outcome.artifact) return {};
  return {DecodeAnalysis(worker.store->Get(outcome.artifact->key).value()).value(), *outcome.output_key};
}

TEST(TaskExecutor, AnAnalysisHasTheMaskAndThePriorOfItsView) {
  SmallJob job;
  const testing_support::TemporaryFolder folder;
  const auto [plain, plain_key] = AnalysisOf(job.Analyse(0, 0), job.config);
  const int width = plain.picture.width();
  const int height = plain.picture.height();
  EXPECT_TRUE(plain.prior.empty());

  TaskSpec spec = job.Analyse(0, 0);
  const auto bright = [](const Ycbcr& pixel) { return pixel.y > 128; };  // a mask that follows the picture
  Grid<std::uint8_t> mask(width, height);
  for (std::size_t i = 0; i < mask.size(); ++i) mask.values()[i] = bright(plain.picture.values()[i]) ? 255 : 0;
  spec.guides.mask = folder.Write("m.png", EncodeGreyPng(mask).value());
  const auto [masked, masked_key] = AnalysisOf(spec, job.config);
  EXPECT_NE(masked_key, plain_key);
  EXPECT_NE(masked.segments.labels, plain.segments.labels);

  spec.guides = {
      .mask = "",
      .prior = folder.Write("p.pfm", EncodePfm(Grid<float>(width, height, 4))),
      .prior_confidence = folder.Write("c.png", EncodeGreyPng(Grid<std::uint8_t>(width, height, 51)).value())};
  job.config.resolved.views[0].prior = {PriorFormat::Holds::kDepth, 0.5, 0, 0};
  const auto [guided, guided_key] = AnalysisOf(spec, job.config);
  EXPECT_NE(guided_key, plain_key);
  EXPECT_EQ(guided.segments, plain.segments);
  ASSERT_EQ(guided.prior.segments.size(), guided.segments.centers.size());
  EXPECT_EQ(guided.prior.At(3, 4), 0.5);  // 4 of half a unit of length
  EXPECT_FLOAT_EQ(guided.prior.segments[0].weight, 0.2F);
}

TEST(AnalysisKey, DependsOnAllThatTheAnalysisDependsOnAndOnNothingElse) {
  const SmallJob job;
  const JobView view = job.config.resolved.views[0];
  const EstimationParams params = job.config.resolved.params;
  const AnalysisDigests digest{
      .picture = Sha256("picture"), .mask = {}, .prior = {}, .prior_confidence = {}, .before = {}};
  std::vector<ArtifactKey> keys{AnalysisKey(view, params, digest)};
  const auto with_digests = [&](const auto& change) {
    AnalysisDigests other = digest;
    change(other);
    keys.push_back(AnalysisKey(view, params, other));
  };
  with_digests([](AnalysisDigests& d) { d.picture = Sha256("other"); });
  with_digests([](AnalysisDigests& d) { d.mask = Sha256("mask"); });
  with_digests([](AnalysisDigests& d) { d.before = Sha256("frame before"); });
  with_digests([](AnalysisDigests& d) { d.prior = Sha256("mask"); });
  with_digests([](AnalysisDigests& d) { d.prior = Sha256("prior"); });
  with_digests([](AnalysisDigests& d) { d.prior = Sha256("prior"), d.prior_confidence = Sha256("sure"); });
  const auto with_view = [&](const auto& change) {
    JobView changed = view;
    change(changed);
    keys.push_back(AnalysisKey(changed, params, digest));
  };
  with_view([](JobView& v) { ++v.source_width; });
  with_view([](JobView& v) { ++v.source_height; });
  with_view([](JobView& v) { ++v.segments; });
  with_view([](JobView& v) { v.format.kind = PictureFormat::Kind::kImage; });
  with_view([](JobView& v) { v.format.bits = 10; });
  with_view([](JobView& v) { v.format.full_range = false; });
  with_view([](JobView& v) { v.format.bt709 = true; });
  EstimationParams changed = params;
  changed.downscale = 2;
  keys.push_back(AnalysisKey(view, changed, digest));
  changed = params;
  changed.snic_compactness += 1e-12;
  keys.push_back(AnalysisKey(view, changed, digest));
  AnalysisDigests of_p_frame = digest;  // where a picture stands still it has the segments of the frame before
  of_p_frame.before = Sha256("frame before");
  changed = params;
  ++changed.p_threshold;
  keys.push_back(AnalysisKey(view, changed, of_p_frame));
  const std::set<ArtifactKey> distinct(keys.begin(), keys.end());
  EXPECT_EQ(distinct.size(), keys.size());

  EXPECT_EQ(AnalysisKey(view, changed, digest), keys[0]);  // an I frame's does not ask for it
  changed = params;
  changed.levels = 99;
  changed.smoothing = 9;
  JobView moved = view;
  moved.camera.name = "elsewhere";
  moved.camera.cam_from_world_translation.x() += 1;
  EXPECT_EQ(AnalysisKey(moved, changed, digest), keys[0]);
}

TEST(TaskExecutor, AJobThatKeepsItsResultsMakesTheSameFilesAsOneArtifact) {
  SmallJob job;
  job.config.resolved.params.confidence = true;
  TestWorker worker;
  const Status status = job.RunOn({&worker});
  ASSERT_TRUE(status.ok()) << status.message();

  JobConfig kept = job.config;
  kept.output_dir.clear();
  kept.keeps_results = true;
  TaskSpec emit = job.Emit(1);
  EXPECT_EQ(worker.Execute(emit, kept).status.code(), ErrorCode::kInvalidArgument) << "it has a staging folder";
  emit.staging.clear();
  emit.output_key = ArtifactKey{7};
  EXPECT_EQ(worker.Execute(emit, job.config).status.code(), ErrorCode::kInvalidArgument) << "it has none";
  const TaskOutcome made = worker.Execute(emit, kept);
  ASSERT_TRUE(made.status.ok()) << made.status.message();
  ASSERT_TRUE(made.artifact.has_value());
  EXPECT_FALSE(made.stats.reused);
  const std::string bundle = worker.store->Get(ArtifactKey{7}).value();
  const std::vector<BundledFile> files = DecodeFileBundle(bundle).value();
  ASSERT_THAT(files, SizeIs(6));
  ASSERT_THAT(made.files, SizeIs(6));
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string path(files[i].path);
    EXPECT_EQ(files[i].bytes, ReadFileBytes((job.output() / path).string(), 1 << 20).value()) << path;
    EXPECT_EQ(made.files[i], (OutputFile{path, Sha256(files[i].bytes), files[i].bytes.size()}));
  }
  EXPECT_EQ(files[3].path, "confidence/cam0/0006.png");

  const TaskOutcome again = worker.Execute(emit, kept);
  ASSERT_TRUE(again.status.ok()) << again.status.message();
  EXPECT_TRUE(again.stats.reused);
  EXPECT_EQ(again.files, made.files);
  EXPECT_EQ(again.artifact, made.artifact);
}

TEST(TaskExecutor, AnAnalysisIsTheSameWhetherItsPictureIsReadOrFetched) {
  SmallJob job;
  TestWorker reader;
  const TaskSpec spec = job.Analyse(0, 1);
  const TaskOutcome read = reader.Execute(spec, job.config);
  ASSERT_TRUE(read.status.ok()) << read.status.message();

  const std::string bytes = ReadFileBytes(spec.picture, 1 << 20).value();
  TestWorker submitter;  // its store stands for the submitter's files
  ASSERT_TRUE(submitter.store->Put(Sha256(bytes), bytes).ok());
  TestWorker worker;
  worker.fetcher.stores = {submitter.store.get()};
  TaskSpec uploaded = spec;
  uploaded.picture = "/nowhere/0000.y";
  uploaded.uploads =
      UploadedSources{{.picture = {Sha256(bytes), bytes.size()}, .mask = {}, .prior = {}, .prior_confidence = {}},
                      {"ipc:///submitter", ""}};
  const TaskOutcome fetched = worker.Execute(uploaded, job.config);
  ASSERT_TRUE(fetched.status.ok()) << fetched.status.message();
  EXPECT_EQ(fetched.output_key, read.output_key);
  EXPECT_EQ(fetched.artifact, read.artifact);
  EXPECT_EQ(fetched.picture_digest, read.picture_digest);
  EXPECT_EQ(fetched.stats.fetched_bytes, bytes.size());
  EXPECT_EQ(worker.fetcher.fetches, 1);

  // What was made before is found by the digests alone.
  const TaskOutcome again = worker.Execute(uploaded, job.config);
  EXPECT_TRUE(again.stats.reused);
  EXPECT_EQ(worker.fetcher.fetches, 1);
}

}  // namespace
}  // namespace depthfarm
