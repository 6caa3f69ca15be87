// What Analyse makes, and the key of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "tests/worker/execution/small_job.h"
#include "worker/artifacts/artifact_digest.h"
#include "worker/execution/analysis_key.h"
#include "worker/segmentation/analysis_codec.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(AnalyseTask, AnErrorOfAPictureNamesCameraFrameAndFile) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(AnalyseFirstFrame(job, worker).ok());
  std::ofstream(job.picture(1, 2)) << "too short";
  const TaskOutcome outcome = worker.Execute(job.Analyse(1, 2), job.config);
  EXPECT_EQ(outcome.status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(outcome.status.message(), HasSubstr("camera 'cam2', frame 6"));
  EXPECT_THAT(outcome.status.message(), HasSubstr(job.picture(1, 2).string()));
}

TEST(AnalyseTask, AnAnalysisOfAPFrameIsGivenThatOfTheFrameBeforeAndNoOther) {
  SmallJob job;
  TestWorker worker;
  ASSERT_TRUE(AnalyseFirstFrame(job, worker).ok());
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

TEST(AnalyseTask, AMissingPictureMayBeReadableElsewhere) {
  SmallJob job;
  TestWorker worker;
  fs::remove(job.picture(0, 0));
  const TaskOutcome outcome = worker.Execute(job.Analyse(0, 0), job.config);
  EXPECT_EQ(outcome.status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(outcome.status.message(), HasSubstr("camera 'cam0', frame 5"));
}

// What an analysis of the first picture holds, and its name.
std::pair<ViewAnalysis, ArtifactKey> AnalysisOf(const TaskSpec& spec, const JobConfig& config) {
  TestWorker worker;
  const TaskOutcome outcome = worker.Execute(spec, config);
  EXPECT_TRUE(outcome.status.ok()) << outcome.status.message();
  if (!outcome.artifact) return {};
  return {DecodeAnalysis(worker.store->Get(outcome.artifact->key).value()).value(), *outcome.output_key};
}

TEST(AnalyseTask, AnAnalysisHasTheMaskAndThePriorOfItsView) {
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

TEST(AnalyseTask, AnAnalysisIsTheSameWhetherItsPictureIsReadOrFetched) {
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
  uploaded.uploads = UploadedSources{{.picture = {{Sha256(bytes), bytes.size()}, DigestOfArtifact(bytes)},
                                      .mask = {},
                                      .prior = {},
                                      .prior_confidence = {}},
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

TEST(AnalyseTask, AnUploadThatIsAnotherFileThanNamedIsRefused) {
  SmallJob job;
  // Served under the name of a picture that others may have: its results would be found by them.
  const std::string bytes = ReadFileBytes(job.picture(0, 0), 1 << 20).value();
  const std::string other(bytes.size(), 'x');
  TestWorker submitter;
  ASSERT_TRUE(submitter.store->Put(Sha256(bytes), other).ok());
  TestWorker worker;
  worker.fetcher.stores = {submitter.store.get()};
  TaskSpec spec = job.Analyse(0, 0);
  spec.uploads = UploadedSources{{.picture = {{Sha256(bytes), bytes.size()}, DigestOfArtifact(other)},
                                  .mask = {},
                                  .prior = {},
                                  .prior_confidence = {}},
                                 {"ipc:///submitter", ""}};
  for (int time = 0; time < 2; ++time) {  // fetched, then from the store
    const TaskOutcome outcome = worker.Execute(spec, job.config);
    EXPECT_EQ(outcome.status.code(), ErrorCode::kCorrupt);
    EXPECT_THAT(outcome.status.message(), HasSubstr("its SHA-256 is not what the submitter said"));
  }
}

}  // namespace
}  // namespace depthfarm
