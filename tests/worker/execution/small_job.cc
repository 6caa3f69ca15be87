#include "tests/worker/execution/small_job.h"

#include <fstream>

#include "common/digest/sha256.h"
#include "common/sequence/sequence.h"
#include "tests/support/plane_scene.h"
#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 36;
constexpr int kFrames = 2;
constexpr int kViews = 3;
constexpr int kFirstFrame = 5;

}  // namespace

Result<std::string> StoreFetcher::Fetch(const TaskInput& input, const std::stop_token&) {
  ++fetches;
  for (ArtifactStore* store : stores) {
    Result<std::string> bytes = store->Get(input.artifact.key);
    if (bytes.ok() && DigestOfArtifact(*bytes) == input.artifact.content_digest) return bytes;
  }
  return Unavailable("nobody has it");
}

TestWorker::TestWorker(int threads)
    : store(ArtifactStore::Open(folder.path() / "store", 64 << 20).value()),
      owned_executor(std::make_unique<TaskExecutor>(*store, cache, fetcher, threads)),
      executor(*owned_executor) {}

SmallJob::SmallJob() {
  Sequence sequence;
  sequence.name = "planes";
  sequence.z_near = 4;
  sequence.z_far = 20;
  for (int view = 0; view < kViews; ++view) {
    SequenceCamera camera;
    camera.camera = ForwardCamera("cam" + std::to_string(view), 0.5 * view, 0, kWidth, kHeight, 40);
    camera.format = {.kind = PictureFormat::Kind::kYuv400, .bits = 8, .full_range = true, .bt709 = false};
    camera.images.assign(kFirstFrame, "/not/of/this/job");
    for (int frame = 0; frame < kFrames; ++frame) {
      const TexturedPlane wall{.point = {0, 0, 12}, .normal = {0, 0, 1}, .base = 110, .frequency = 0.7};
      const double left = -1.0 + 0.3 * frame;  // a board that moves
      const TexturedPlane board{.point = {0, 0, 6}, .normal = {0, 0, 1}, .min_x = left, .max_x = left + 1.5};
      const PlaneView rendered = RenderPlanes(camera.camera, {wall, board});
      std::string luma;
      for (const Ycbcr& pixel : rendered.picture.values()) luma.push_back(static_cast<char>(pixel.y));
      std::ofstream(picture(frame, view), std::ios::binary) << luma;
      camera.images.push_back(picture(frame, view).string());
    }
    sequence.cameras.push_back(camera);
  }
  EstimationParams params;
  params.levels = 8;
  params.segments = 80;
  params.gop = 2;
  params.level_blocks = 2;
  params.refine_rounds = 2;
  params.first_frame = kFirstFrame;
  config.job = JobId{3};
  config.resolved = ResolveJob(sequence, params).value();
  config.resolved.level_blocks_p = 2;
  config.output_dir = output().string();
  config.sequence_name = sequence.name;
}

std::filesystem::path SmallJob::picture(int frame, int view) const {
  return folder_.path() / (std::to_string(frame) + "-" + std::to_string(view) + ".y");
}

TaskSpec SmallJob::Spec(TaskKind kind, int frame, int index) const {
  TaskSpec spec;
  spec.id = {.job = config.job, .frame = frame, .kind = kind, .index = index, .pair = 0};
  return spec;
}

TaskSpec SmallJob::Simple(TaskKind kind) const { return Spec(kind, 0, 0); }

TaskSpec SmallJob::Analyse(int frame, int view) const {
  TaskSpec spec = Spec(TaskKind::kAnalyse, frame, view);
  spec.picture = picture(frame, view).string();
  if (frame > 0) AddOfView(spec, InputRole::kPreviousAnalysis, Spec(TaskKind::kAnalyse, frame - 1, view).id, view);
  return spec;
}

TaskId SmallJob::FinalLabels(int frame) {
  return {.job = JobId{3}, .frame = frame, .kind = TaskKind::kMerge, .index = 0, .pair = 0};
}

TaskId SmallJob::Refined(int frame, int round, int view) {
  return {.job = JobId{3}, .frame = frame, .kind = TaskKind::kRefine, .index = round, .pair = view};
}

void SmallJob::AddOfView(TaskSpec& spec, InputRole role, const TaskId& producer, int view) const {
  spec.inputs.push_back({.artifact = artifacts_.at(producer), .role = role, .view = view, .locations = {}});
}

void SmallJob::AddAnalyses(TaskSpec& spec, InputRole role, int frame) const {
  for (int view = 0; view < kViews; ++view) AddOfView(spec, role, Spec(TaskKind::kAnalyse, frame, view).id, view);
}

void SmallJob::AddLabels(TaskSpec& spec, InputRole role, const TaskId& producer) const {
  spec.inputs.push_back({.artifact = artifacts_.at(producer), .role = role, .view = 0, .locations = {}});
}

TaskSpec SmallJob::Estimate(int frame, int block) const {
  TaskSpec spec = Spec(TaskKind::kEstimate, frame, block);
  AddAnalyses(spec, InputRole::kAnalysis, frame);
  if (frame > 0) {
    AddAnalyses(spec, InputRole::kPreviousAnalysis, frame - 1);
    AddLabels(spec, InputRole::kPreviousLabels, FinalLabels(frame - 1));
    AddAnalyses(spec, InputRole::kIAnalysis, 0);
    AddLabels(spec, InputRole::kILabels, FinalLabels(0));
  }
  spec.output_key = Sha256(TaskName(spec.id));
  return spec;
}

TaskSpec SmallJob::Merge(int frame) const {
  TaskSpec spec = Spec(TaskKind::kMerge, frame, 0);
  AddAnalyses(spec, InputRole::kAnalysis, frame);
  for (int block = 0; block < 2; ++block) {
    AddLabels(spec, InputRole::kLabels, Spec(TaskKind::kEstimate, frame, block).id);
  }
  spec.output_key = Sha256(TaskName(spec.id));
  return spec;
}

TaskSpec SmallJob::Refine(int frame, int round, int view) const {
  TaskSpec spec;
  spec.id = Refined(frame, round, view);
  const auto analysis = [&](int of_frame, int of_view) { return Spec(TaskKind::kAnalyse, of_frame, of_view).id; };
  const int last = config.resolved.params.refine_rounds;
  if (round == 0) {
    AddOfView(spec, InputRole::kAnalysis, analysis(frame, view), view);
    if (frame > 0) AddOfView(spec, InputRole::kPreviousAnalysis, analysis(frame - 1, view), view);
    if (frame > 0) AddOfView(spec, InputRole::kIAnalysis, analysis(0, view), view);
    AddLabels(spec, InputRole::kLabels, FinalLabels(frame));
    if (frame > 0) AddOfView(spec, InputRole::kPreviousRefined, Refined(frame - 1, last, view), view);
    if (frame > 0) AddOfView(spec, InputRole::kIRefined, Refined(0, last, view), view);
  } else {  // three views: each is compared with both others
    AddAnalyses(spec, InputRole::kAnalysis, frame);
    for (int v = 0; v < kViews; ++v) AddOfView(spec, InputRole::kRefined, Refined(frame, round - 1, v), v);
  }
  spec.output_key = Sha256(TaskName(spec.id));
  return spec;
}

TaskSpec SmallJob::Assess(int frame, int view) const {  // three views: each is compared with both others
  TaskSpec spec = Spec(TaskKind::kAssess, frame, view);
  const int last = config.resolved.params.refine_rounds;
  AddAnalyses(spec, InputRole::kAnalysis, frame);
  for (int v = 0; v < kViews; ++v) AddOfView(spec, InputRole::kRefined, Refined(frame, last, v), v);
  spec.output_key = Sha256(TaskName(spec.id));
  return spec;
}

TaskSpec SmallJob::Emit(int frame) const {
  TaskSpec spec = Spec(TaskKind::kEmit, frame, 0);
  const EstimationParams& params = config.resolved.params;
  const int last = params.refine_rounds;
  if (last > 0) {
    for (int v = 0; v < kViews; ++v) AddOfView(spec, InputRole::kRefined, Refined(frame, last, v), v);
    for (int v = 0; params.assesses() && v < kViews; ++v)
      AddOfView(spec, InputRole::kConfidence, Spec(TaskKind::kAssess, frame, v).id, v);
  } else {
    AddAnalyses(spec, InputRole::kAnalysis, frame);
    AddLabels(spec, InputRole::kLabels, FinalLabels(frame));
  }
  spec.staging = "frame-" + std::to_string(frame);
  return spec;
}

TaskSpec SmallJob::Commit(int frame) const {
  TaskSpec spec = Spec(TaskKind::kCommit, frame, 0);
  spec.staging = "frame-" + std::to_string(frame);
  spec.files = files_.at(frame);
  return spec;
}

TaskSpec SmallJob::Manifest() const {
  TaskSpec spec = Spec(TaskKind::kManifest, 0, 0);
  for (const auto& [frame, files] : files_) spec.files.insert(spec.files.end(), files.begin(), files.end());
  for (const auto& [id, digest] : pictures_) spec.picture_digests.push_back(digest);
  return spec;
}

void SmallJob::Note(const TaskSpec& spec, const TaskOutcome& outcome) {
  if (outcome.artifact.has_value()) artifacts_[spec.id] = *outcome.artifact;
  if (outcome.picture_digest.has_value()) pictures_[spec.id] = *outcome.picture_digest;
  if (spec.id.kind == TaskKind::kEmit) files_[spec.id.frame] = outcome.files;
}

Status SmallJob::RunOn(const std::vector<TestWorker*>& workers) {
  std::size_t turn = 0;
  const auto run = [&](const TaskSpec& spec) {
    const TaskOutcome outcome = workers[turn++ % workers.size()]->Execute(spec, config);
    Note(spec, outcome);
    return outcome.status.WithContext(TaskName(spec.id));
  };
  DEPTHFARM_RETURN_IF_ERROR(run(Simple(TaskKind::kPrepare)));
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int view = 0; view < kViews; ++view) DEPTHFARM_RETURN_IF_ERROR(run(Analyse(frame, view)));
    for (int block = 0; block < 2; ++block) DEPTHFARM_RETURN_IF_ERROR(run(Estimate(frame, block)));
    DEPTHFARM_RETURN_IF_ERROR(run(Merge(frame)));
    const int last = config.resolved.params.refine_rounds;
    for (int round = 0; last > 0 && round <= last; ++round)
      for (int view = 0; view < kViews; ++view) DEPTHFARM_RETURN_IF_ERROR(run(Refine(frame, round, view)));
    for (int view = 0; config.resolved.params.assesses() && view < kViews; ++view)
      DEPTHFARM_RETURN_IF_ERROR(run(Assess(frame, view)));
    DEPTHFARM_RETURN_IF_ERROR(run(Emit(frame)));
    DEPTHFARM_RETURN_IF_ERROR(run(Commit(frame)));
  }
  return run(Manifest());
}

Status AnalyseFirstFrame(SmallJob& job, TestWorker& worker) {
  for (int view = 0; view < 3; ++view) {
    const TaskSpec spec = job.Analyse(0, view);
    const TaskOutcome outcome = worker.Execute(spec, job.config);
    DEPTHFARM_RETURN_IF_ERROR(outcome.status);
    job.Note(spec, outcome);
  }
  return {};
}

}  // namespace depthfarm
