#include "worker/execution/task_executor.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <iterator>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>

#include "common/base/parallel.h"
#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/files/file_bundle.h"
#include "common/job/job_manifest.h"
#include "common/media/colour_map.h"
#include "common/media/depth_file.h"
#include "common/media/guide_files.h"
#include "common/media/picture_reader.h"
#include "common/sequence/output_layout.h"
#include "worker/confidence/confidence.h"
#include "worker/confidence/confidence_codec.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/label_field_codec.h"
#include "worker/execution/analysis_key.h"
#include "worker/execution/fetch_ahead.h"
#include "worker/execution/output_folder.h"
#include "worker/execution/resource_usage.h"
#include "worker/execution/uploaded_files.h"
#include "worker/execution/views_manifest.h"
#include "worker/refinement/refine.h"
#include "worker/refinement/refined_view_codec.h"
#include "worker/rendering/source_views.h"
#include "worker/segmentation/analysis_codec.h"
#include "worker/segmentation/mask_trust.h"
#include "worker/segmentation/view_prior.h"

namespace depthfarm {

// What the steps of one task share.
struct TaskExecutor::Task {
  const TaskSpec& spec;
  const JobConfig& config;
  const std::stop_token& stop;
  const StillLeased& still_leased;
  TaskInputs& inputs;
  const FileRoots& roots;

  [[nodiscard]] const ResolvedJob& job() const { return config.resolved; }
  [[nodiscard]] int SequenceFrame() const { return job().params.first_frame + spec.id.frame; }
  [[nodiscard]] std::string FrameName() const {
    return config.render ? "part " + std::to_string(spec.id.frame) : "frame " + std::to_string(SequenceFrame());
  }
  [[nodiscard]] Result<OutputFolder> Output() const {
    DEPTHFARM_RETURN_IF_ERROR(roots.CheckWrite(config.output_dir));
    return OutputFolder::At(config.output_dir, config.render ? OutputContent::kViews : OutputContent::kDepth,
                            {.run = config.claim, .still_leased = still_leased});
  }
  // Of the first input of that role.
  [[nodiscard]] std::optional<ArtifactKey> KeyOf(InputRole role) const {
    for (const TaskInput& input : spec.inputs)
      if (input.role == role) return input.artifact.key;
    return std::nullopt;
  }
  [[nodiscard]] Status LoadInputs() const { return inputs.Load(spec, job().num_views()).WithContext(FrameName()); }
};

namespace {

// Every kind that has a frame names one of the job.
Status CheckFrame(const TaskSpec& spec, const ResolvedJob& job) {
  if (spec.id.frame >= 0 && spec.id.frame < job.num_frames) return {};
  return InvalidArgument(TaskName(spec.id) + ": the job has frames 0 to " + std::to_string(job.num_frames - 1));
}

// A rendering job has no cameras to estimate, another one no views to render.
Status CheckKind(const TaskId& id, const JobConfig& config) {
  const bool of_estimation = id.kind == TaskKind::kAnalyse || id.kind == TaskKind::kEstimate ||
                             id.kind == TaskKind::kMerge || id.kind == TaskKind::kRefine ||
                             id.kind == TaskKind::kAssess || id.kind == TaskKind::kEmit;
  if (config.render ? !of_estimation : id.kind != TaskKind::kRender) return {};
  return InvalidArgument(TaskName(id) + ": the job " + (config.render ? "renders views" : "estimates depth"));
}

void Count(const EstimationStats& from, TaskStats& to) {
  to.sweeps = static_cast<std::uint32_t>(from.sweeps);
  to.energy = from.energy;
  to.nodes = static_cast<std::uint32_t>(from.nodes);
  to.segments = static_cast<std::uint32_t>(from.segments);
}

std::vector<ArtifactKey> KeysOf(const TaskSpec& spec) {
  std::vector<ArtifactKey> keys;
  for (const TaskInput& input : spec.inputs) keys.push_back(input.artifact.key);
  for (const TaskInput& upload : UploadsOf(spec)) keys.push_back(upload.artifact.key);
  if (spec.output_key.has_value()) keys.push_back(*spec.output_key);
  return keys;
}

std::string Encode(const LabelField& field) { return EncodeLabelField(field); }
std::string Encode(const RefinedView& view) { return EncodeRefinedView(view); }
std::string Encode(const ConfidenceMap& map) { return EncodeConfidence(map); }

// Leaves no depth where its confidence is less than `least`.
void MakeHoles(const ConfidenceMap& confidence, double least, Grid<std::uint16_t>& codes) {
  const double bound = least * kConfidenceScale;
  for (std::size_t i = 0; i < codes.size(); ++i)
    if (confidence.codes.values()[i] < bound) codes.values()[i] = 0;
}

// Round 0 of Refine.
Result<RefinedView> StartOf(const TaskSpec& spec, const ResolvedJob& job, const TaskInputs& inputs) {
  const auto v = static_cast<std::size_t>(spec.id.pair);
  const auto analysis = [&](InputRole role) { return inputs.ListedAnalyses(role)[v]; };
  const auto refined = [&](InputRole role) { return inputs.ListedRefined(role)[v]; };
  const auto own = analysis(InputRole::kAnalysis);
  DEPTHFARM_ASSIGN_OR_RETURN(const auto labels, inputs.Labels(InputRole::kLabels, 1));
  if (own == nullptr || labels[0]->views.size() != job.views.size())
    return InvalidArgument(TaskName(spec.id) + ": expected the view's analysis and labels of all views");
  if (job.IsIFrame(spec.id.frame)) return StartRefinement(job, spec.id.pair, *own, labels[0]->views[v], nullptr);
  const RefinementReferences references{{analysis(InputRole::kPreviousAnalysis), refined(InputRole::kPreviousRefined)},
                                        {analysis(InputRole::kIAnalysis), refined(InputRole::kIRefined)}};
  for (const ReferenceView* reference : {&references.previous, &references.i_frame}) {
    if (reference->analysis == nullptr || reference->refined == nullptr)
      return InvalidArgument(TaskName(spec.id) + ": expected analysis and refined depth of the frames it refers to");
  }
  return StartRefinement(job, spec.id.pair, *own, labels[0]->views[v], &references);
}

}  // namespace

TaskOutcome TaskExecutor::Execute(const TaskSpec& spec, const JobConfig& config, const std::stop_token& stop,
                                  const StillLeased& still_leased) {
  const ResourceUsage before = UsageOfThread();
  const auto start = std::chrono::steady_clock::now();
  TaskOutcome outcome;
  TaskInputs inputs(store_, cache_, fetcher_, stop);
  try {
    outcome.pins = std::make_shared<std::vector<ArtifactPins>>();
    outcome.pins->push_back(store_.Pin(KeysOf(spec)));
    outcome.status = Run({spec, config, stop, still_leased, inputs, roots_}, outcome);
  } catch (const std::bad_alloc&) {
    outcome.status = Unavailable(TaskName(spec.id) + ": no memory left on this worker");
  } catch (const std::exception& error) {
    outcome.status = Internal(TaskName(spec.id) + ": " + error.what());
  }
  if (stop.stop_requested() && !outcome.status.ok()) outcome.status = Cancelled();
  outcome.missing_inputs = inputs.missing();
  const ResourceUsage after = UsageOfThread();
  outcome.stats.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.stats.cpu_seconds = after.cpu_seconds - before.cpu_seconds;
  outcome.stats.peak_memory_bytes = after.peak_memory_bytes;
  outcome.stats.fetch_seconds = inputs.fetch_seconds();
  outcome.stats.fetched_bytes += inputs.fetched_bytes();
  return outcome;
}

Status TaskExecutor::Run(const Task& task, TaskOutcome& outcome) {
  if (task.config.algorithm_version != kAlgorithmVersion) {
    return {ErrorCode::kIncompatible, "the job pins algorithm version " +
                                          std::to_string(task.config.algorithm_version) + ", this worker has " +
                                          std::to_string(kAlgorithmVersion)};
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckFrame(task.spec, task.job()));
  DEPTHFARM_RETURN_IF_ERROR(CheckKind(task.spec.id, task.config));
  for (const ArtifactKey& key : passed_rounds_.PassedBy(task.spec)) cache_.Erase(key);
  if (task.spec.id.kind != TaskKind::kRefine) refining_.Clear();
  switch (task.spec.id.kind) {
    case TaskKind::kAnalyse:
      return Analyse(task, outcome);
    case TaskKind::kEstimate:
      return Estimate(task, outcome);
    case TaskKind::kMerge:
      return Merge(task, outcome);
    case TaskKind::kRefine:
      return Refine(task, outcome);
    case TaskKind::kAssess:
      return Assess(task, outcome);
    case TaskKind::kEmit:
      return Emit(task, outcome);
    case TaskKind::kRender:
      return Render(task, outcome).WithContext(task.FrameName());
    case TaskKind::kCommit:
      return Commit(task);
    case TaskKind::kManifest:
      return Manifest(task);
    case TaskKind::kPrepare: {
      DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, task.Output());
      return task.spec.files.empty() ? folder.Prepare() : folder.Resume(task.spec.files);
    }
    case TaskKind::kCleanup: {
      DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, task.Output());
      return folder.RemoveStaging();
    }
  }
  return InvalidArgument("task of an unknown kind");
}

Status TaskExecutor::Analyse(const Task& task, TaskOutcome& outcome) {
  const int view_index = task.spec.id.index;
  if (view_index < 0 || view_index >= task.job().num_views()) {
    return InvalidArgument(TaskName(task.spec.id) + ": the job has " + std::to_string(task.job().num_views()) +
                           " views");
  }
  const JobView& view = task.job().views[static_cast<std::size_t>(view_index)];
  return AnalysePicture(task, view, outcome).WithContext("camera '" + view.camera.name + "', " + task.FrameName());
}

namespace {

constexpr std::uint64_t kMaxGuideBytes = std::uint64_t{1} << 32;

// The bytes of the files that guide a view; nothing where there is none.
struct GuideBytes {
  std::optional<std::string> mask;
  std::optional<std::string> prior;
  std::optional<std::string> prior_confidence;
};

// Reads a guide: by its path, or what the submitter serves of it.
using ReadFile = std::function<Result<std::string>(const std::string& path, const std::optional<FileDigest>& upload)>;

Result<std::optional<std::string>> ReadGuide(const ReadFile& read, const std::string& path,
                                             const std::optional<FileDigest>& upload) {
  if (path.empty()) return std::optional<std::string>();
  DEPTHFARM_ASSIGN_OR_RETURN(std::string bytes, read(path, upload));
  return std::optional<std::string>(std::move(bytes));
}

Result<GuideBytes> ReadGuides(const ReadFile& read, const TaskSpec& spec) {
  const GuideFiles& files = spec.guides;
  const SourceDigests uploads = spec.uploads ? spec.uploads->files : SourceDigests();
  GuideBytes guides;
  DEPTHFARM_ASSIGN_OR_RETURN(guides.mask, ReadGuide(read, files.mask, uploads.mask));
  DEPTHFARM_ASSIGN_OR_RETURN(guides.prior, ReadGuide(read, files.prior, uploads.prior));
  if (guides.prior.has_value()) {
    DEPTHFARM_ASSIGN_OR_RETURN(guides.prior_confidence,
                               ReadGuide(read, files.prior_confidence, uploads.prior_confidence));
  }
  return guides;
}

// Of uploads the job says them: equal files give equal names, however they are read.
AnalysisDigests DigestsOf(const SourceDigests& uploads) {
  const auto digest = [](const std::optional<FileDigest>& file) {
    return file ? std::optional<ContentDigest>(file->sha256) : std::nullopt;
  };
  return {.picture = uploads.picture.sha256,
          .mask = digest(uploads.mask),
          .prior = digest(uploads.prior),
          .prior_confidence = uploads.prior ? digest(uploads.prior_confidence) : std::nullopt,
          .before = {}};
}

std::optional<ContentDigest> DigestOf(const std::optional<std::string>& bytes) {
  return bytes.has_value() ? std::optional<ContentDigest>(Sha256(*bytes)) : std::nullopt;
}

Result<ViewPrior> PriorOf(const GuideBytes& guides, const GuideFiles& files, const PriorFormat& format,
                          const SegmentMap& segments) {
  const int width = segments.labels.width();
  const int height = segments.labels.height();
  Result<Grid<float>> values = DecodePrior(*guides.prior, format, width, height);
  if (!values.ok()) return values.status().WithContext(files.prior);
  Grid<float> confidence;
  if (guides.prior_confidence.has_value()) {
    Result<Grid<float>> shares = DecodeShare(*guides.prior_confidence, width, height);
    if (!shares.ok()) return shares.status().WithContext(files.prior_confidence);
    confidence = std::move(*shares);
  }
  ViewPrior prior = MakePrior(*values, confidence);
  prior.segments = DescribePrior(segments, prior);
  return prior;
}

}  // namespace

Status TaskExecutor::AnalysePicture(const Task& task, const JobView& view, TaskOutcome& outcome) {
  const std::string& path = task.spec.picture;
  const EstimationParams& params = task.job().params;
  const bool refers = !task.job().IsIFrame(task.spec.id.frame);
  if (refers != task.KeyOf(InputRole::kPreviousAnalysis).has_value()) {
    return InvalidArgument(TaskName(task.spec.id) + (refers ? ": expected the analysis of the frame before"
                                                            : ": expected no analysis of another frame"));
  }
  const ReadFile read = [&](const std::string& file, const std::optional<FileDigest>& upload) -> Result<std::string> {
    if (!task.spec.uploads) {
      DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(file));
      return ReadFileBytes(file, kMaxGuideBytes);
    }
    return ReadUpload(store_, fetcher_, upload.value_or(FileDigest()), task.spec.uploads->from, file, task.stop,
                      outcome.stats.fetched_bytes);
  };
  GuideBytes guides;
  YcbcrImage picture;
  {
    std::string bytes;
    AnalysisDigests digests;
    if (task.spec.uploads) {
      digests = DigestsOf(task.spec.uploads->files);
    } else {
      DEPTHFARM_ASSIGN_OR_RETURN(guides, ReadGuides(read, task.spec));
      DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(path));
      DEPTHFARM_ASSIGN_OR_RETURN(bytes, ReadPictureBytes(path, view.format, view.source_width, view.source_height));
      digests = {.picture = Sha256(bytes),
                 .mask = DigestOf(guides.mask),
                 .prior = DigestOf(guides.prior),
                 .prior_confidence = DigestOf(guides.prior_confidence),
                 .before = {}};
    }
    digests.before = task.KeyOf(InputRole::kPreviousAnalysis);
    const ArtifactKey key = AnalysisKey(view, params, digests);
    outcome.picture_digest = digests.picture;
    outcome.output_key = key;
    outcome.pins->push_back(store_.Pin({key}));
    if (task.spec.known.has_value() && task.spec.known->artifact.key == key)
      outcome.stats.fetched_bytes += FetchIntoStore(store_, fetcher_, *task.spec.known, task.stop);
    if (const auto known = FindMade<ViewAnalysis>(task, key, outcome); known != nullptr) {
      outcome.stats.segments = static_cast<std::uint32_t>(known->segments.num_segments());
      return {};
    }
    if (task.spec.uploads) {
      DEPTHFARM_ASSIGN_OR_RETURN(guides, ReadGuides(read, task.spec));
      DEPTHFARM_ASSIGN_OR_RETURN(bytes, read(path, task.spec.uploads->files.picture));
      ReleaseUploads(task);
    }
    Result<YcbcrImage> decoded =
        DecodePicture(bytes, view.format, view.source_width, view.source_height, params.downscale);
    if (!decoded.ok()) return decoded.status().WithContext(path);
    picture = std::move(*decoded);
  }
  if (guides.mask.has_value()) {
    DEPTHFARM_RETURN_IF_ERROR(ApplyMask(*guides.mask, picture).WithContext(task.spec.guides.mask));
    WeighMask(picture);
  }
  if (task.stop.stop_requested()) return Cancelled();
  DEPTHFARM_ASSIGN_OR_RETURN(ViewAnalysis analysis, SegmentsOf(task, view, std::move(picture)));
  if (guides.prior.has_value()) {
    DEPTHFARM_ASSIGN_OR_RETURN(analysis.prior, PriorOf(guides, task.spec.guides, view.prior, analysis.segments));
  }
  outcome.stats.segments = static_cast<std::uint32_t>(analysis.segments.num_segments());
  DEPTHFARM_ASSIGN_OR_RETURN(outcome.artifact, store_.Put(*outcome.output_key, EncodeAnalysis(analysis)));
  cache_.Put(*outcome.output_key, std::make_shared<const ViewAnalysis>(std::move(analysis)));
  return {};
}

void TaskExecutor::ReleaseUploads(const Task& task) {
  std::vector<ArtifactKey> read;
  for (const TaskInput& upload : UploadsOf(task.spec)) read.push_back(upload.artifact.key);
  store_.Release(read);
}

Result<ViewAnalysis> TaskExecutor::SegmentsOf(const Task& task, const JobView& view, YcbcrImage picture) {
  const EstimationParams& params = task.job().params;
  if (task.job().IsIFrame(task.spec.id.frame))
    return AnalyseView(std::move(picture), view.segments, params.snic_compactness, task.stop);
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  const auto before =
      task.inputs.ListedAnalyses(InputRole::kPreviousAnalysis)[static_cast<std::size_t>(task.spec.id.index)];
  if (before == nullptr) return InvalidArgument("the analysis of the frame before is another view's");
  return AnalyseNextView(std::move(picture), *before, params.p_threshold, params.snic_compactness, task.stop);
}

Status TaskExecutor::Estimate(const Task& task, TaskOutcome& outcome) {
  const int frame = task.spec.id.frame;
  const int num_blocks = task.job().NumBlocks(frame);
  if (!task.spec.output_key.has_value() || task.spec.id.index < 0 || task.spec.id.index >= num_blocks) {
    return InvalidArgument(TaskName(task.spec.id) + ": expected an output key and a block below " +
                           std::to_string(num_blocks));
  }
  if (Reuse<LabelField>(task, outcome)) return {};
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  DEPTHFARM_ASSIGN_OR_RETURN(const FrameAnalysis analysis, task.inputs.Analyses(InputRole::kAnalysis));
  std::optional<TemporalReferences> references;
  if (!task.job().IsIFrame(frame)) {
    references.emplace();
    DEPTHFARM_ASSIGN_OR_RETURN(references->previous_analysis, task.inputs.Analyses(InputRole::kPreviousAnalysis));
    DEPTHFARM_ASSIGN_OR_RETURN(references->i_analysis, task.inputs.Analyses(InputRole::kIAnalysis));
    DEPTHFARM_ASSIGN_OR_RETURN(const auto previous, task.inputs.Labels(InputRole::kPreviousLabels, 1));
    DEPTHFARM_ASSIGN_OR_RETURN(const auto i_frame, task.inputs.Labels(InputRole::kILabels, 1));
    references->previous_labels = previous[0];
    references->i_labels = i_frame[0];
  }
  EstimationStats stats;
  Result<LabelField> field =
      EstimateBlock(task.job(), analysis, references.has_value() ? &*references : nullptr, num_blocks,
                    task.spec.id.index, task.stop, &stats, floors_.Of(task.job(), analysis), threads_);
  if (!field.ok()) return field.status().WithContext(task.FrameName());
  Count(stats, outcome.stats);
  return Store(task, std::move(*field), outcome);
}

Status TaskExecutor::Merge(const Task& task, TaskOutcome& outcome) {
  if (!task.spec.output_key.has_value()) return InvalidArgument(TaskName(task.spec.id) + ": expected an output key");
  if (Reuse<LabelField>(task, outcome)) return {};
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  DEPTHFARM_ASSIGN_OR_RETURN(const FrameAnalysis analysis, task.inputs.Analyses(InputRole::kAnalysis));
  DEPTHFARM_ASSIGN_OR_RETURN(const auto labels, task.inputs.Labels(InputRole::kLabels, 2));
  EstimationStats stats;
  Result<LabelField> field =
      MergeLabels(task.job(), analysis, *labels[0], *labels[1], task.stop, &stats, floors_.Of(task.job(), analysis));
  if (!field.ok()) return field.status().WithContext(task.FrameName());
  Count(stats, outcome.stats);
  return Store(task, std::move(*field), outcome);
}

Status TaskExecutor::Refine(const Task& task, TaskOutcome& outcome) {
  const ResolvedJob& job = task.job();
  const int round = task.spec.id.index;
  const int view = task.spec.id.pair;
  if (!task.spec.output_key.has_value() || round < 0 || round > job.params.refine_rounds || view < 0 ||
      view >= job.num_views()) {
    return InvalidArgument(TaskName(task.spec.id) + ": expected an output key, a round up to " +
                           std::to_string(job.params.refine_rounds) + " and a view below " +
                           std::to_string(job.num_views()));
  }
  if (Reuse<RefinedView>(task, outcome)) return {};
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  Result<RefinedView> refined =
      round == 0 ? StartOf(task.spec, job, task.inputs)
                 : RefineView(job, view, round, task.inputs.ListedAnalyses(InputRole::kAnalysis),
                              task.inputs.ListedRefined(InputRole::kRefined), refining_, task.stop, threads_);
  if (!refined.ok()) return refined.status().WithContext(task.FrameName());
  return Store(task, std::move(*refined), outcome);
}

Status TaskExecutor::Assess(const Task& task, TaskOutcome& outcome) {
  const ResolvedJob& job = task.job();
  const int view = task.spec.id.index;
  if (!task.spec.output_key.has_value() || view < 0 || view >= job.num_views()) {
    return InvalidArgument(TaskName(task.spec.id) + ": expected an output key and a view below " +
                           std::to_string(job.num_views()));
  }
  if (Reuse<ConfidenceMap>(task, outcome)) return {};
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  Result<ConfidenceMap> map = AssessView(job, view, task.inputs.ListedAnalyses(InputRole::kAnalysis),
                                         task.inputs.ListedRefined(InputRole::kRefined), task.stop);
  if (!map.ok()) return map.status().WithContext(task.FrameName());
  return Store(task, std::move(*map), outcome);
}

Status TaskExecutor::EmitViews(const Task& task, const EmitOne& emit, MadeFiles& made) const {
  const auto num_views = static_cast<std::size_t>(task.job().num_views());
  std::vector<Status> failures(num_views);
  std::vector<MadeFiles> of_views(num_views);
  ParallelFor(num_views, threads_, [&](std::size_t v) { failures[v] = emit(v, of_views[v]); });
  for (const Status& failure : failures) DEPTHFARM_RETURN_IF_ERROR(failure);
  for (MadeFiles& of_view : of_views) {
    std::ranges::move(of_view.files, std::back_inserter(made.files));
    std::ranges::move(of_view.contents, std::back_inserter(made.contents));
  }
  return {};
}

Status TaskExecutor::EmitRefined(const Task& task, MadeFiles& made) const {
  const ResolvedJob& job = task.job();
  const FrameRefinement refined = task.inputs.ListedRefined(InputRole::kRefined);
  const auto confidence = task.inputs.ListedConfidence();
  const auto emit_depth = [&](std::size_t v, MadeFiles& of_view) -> Status {
    const Camera& camera = job.views[v].camera;
    if (refined[v] == nullptr || refined[v]->plane_of_pixel.width() != camera.width ||
        refined[v]->plane_of_pixel.height() != camera.height) {
      return InvalidArgument("camera '" + camera.name + "' has no refined depth of its size");
    }
    Grid<std::uint16_t> codes = RefinedDepthCodes(job, static_cast<int>(v), *refined[v]);
    if (job.params.assesses()) {
      if (confidence[v] == nullptr || confidence[v]->codes.size() != codes.size())
        return InvalidArgument("camera '" + camera.name + "' has no confidence map of its size");
      MakeHoles(*confidence[v], job.params.holes, codes);
    }
    return EmitMap(task, camera.name, DepthFileName(camera.name, task.SequenceFrame()), codes, of_view);
  };
  DEPTHFARM_RETURN_IF_ERROR(EmitViews(task, emit_depth, made));
  if (!job.params.confidence) return {};
  const auto emit_confidence = [&](std::size_t v, MadeFiles& of_view) {
    const std::string& camera = job.views[v].camera.name;
    return EmitMap(task, camera, ConfidenceFileName(camera, task.SequenceFrame()), confidence[v]->codes, of_view);
  };
  return EmitViews(task, emit_confidence, made);
}

Status TaskExecutor::EmitLabels(const Task& task, MadeFiles& made) const {
  const ResolvedJob& job = task.job();
  DEPTHFARM_ASSIGN_OR_RETURN(const FrameAnalysis analysis, task.inputs.Analyses(InputRole::kAnalysis));
  DEPTHFARM_ASSIGN_OR_RETURN(const auto labels, task.inputs.Labels(InputRole::kLabels, 1));
  DEPTHFARM_RETURN_IF_ERROR(CheckAnalysis(job, analysis));
  DEPTHFARM_RETURN_IF_ERROR(CheckLabels(job, analysis, *labels[0]));
  const auto emit_depth = [&](std::size_t v, MadeFiles& of_view) {
    const Grid<std::uint16_t> codes =
        DepthCodes(job, static_cast<int>(v), analysis[v]->segments.labels, labels[0]->views[v]);
    const std::string& camera = job.views[v].camera.name;
    return EmitMap(task, camera, DepthFileName(camera, task.SequenceFrame()), codes, of_view);
  };
  return EmitViews(task, emit_depth, made);
}

Status TaskExecutor::EmitMap(const Task& task, const std::string& camera, const std::string& path,
                             const Grid<std::uint16_t>& codes, MadeFiles& made) {
  if (task.stop.stop_requested()) return Cancelled();
  Result<std::string> png = EncodeDepthPng(codes);
  if (!png.ok()) return png.status().WithContext("camera '" + camera + "'");
  return Stage(task, path, std::move(*png), made);
}

Status TaskExecutor::Stage(const Task& task, std::string path, std::string bytes, MadeFiles& made) {
  OutputFile file{.path = std::move(path), .sha256 = Sha256(bytes), .bytes = bytes.size()};
  if (task.config.keeps_results) {
    made.contents.push_back(std::move(bytes));
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, task.Output());
    DEPTHFARM_RETURN_IF_ERROR(folder.Stage(task.spec.staging, file.path, bytes));
  }
  made.files.push_back(std::move(file));
  return {};
}

Status TaskExecutor::Render(const Task& task, TaskOutcome& outcome) const {
  DEPTHFARM_RETURN_IF_ERROR(task.Output().status());  // before anything is read
  const RenderSource& source = *task.config.render;
  DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(task.config.sequence_file));
  DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(source.depth_dir + "/" + kDepthManifestName));
  DEPTHFARM_ASSIGN_OR_RETURN(const RenderSource found, RenderSourceOf(source.depth_dir));
  if (found.manifest_sha256 != source.manifest_sha256) {
    return InvalidArgument(source.depth_dir +
                           ": depth.json is not the one the job was submitted with; submit it again");
  }
  SequenceWithDepth input;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(task.config.sequence_file, source.depth_dir, input));
  SourceViews sources(input);
  MadeFiles made;
  for (const VirtualPicture& picture : task.spec.views) {
    if (task.stop.stop_requested()) return Cancelled();
    DEPTHFARM_ASSIGN_OR_RETURN(const VirtualView view, FindSources(input, picture));
    for (const std::string& file : FilesOf(input, view)) DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(file));
    DEPTHFARM_RETURN_IF_ERROR(sources.Load(std::span(&view, 1), 1));
    DEPTHFARM_ASSIGN_OR_RETURN(const SynthesizedView rendered, sources.Render(view));
    DEPTHFARM_ASSIGN_OR_RETURN(std::string png, EncodeRgbPng(ToRgb(rendered.picture)));
    DEPTHFARM_RETURN_IF_ERROR(Stage(task, ViewFileName(picture.number), std::move(png), made));
  }
  outcome.files = std::move(made.files);
  return {};
}

Status TaskExecutor::Emit(const Task& task, TaskOutcome& outcome) {
  if (task.config.keeps_results != task.spec.output_key.has_value())
    return InvalidArgument(TaskName(task.spec.id) + ": expected an output key or a staging folder, as its job says");
  if (task.config.keeps_results && ReuseFiles(task, outcome)) return {};
  if (!task.config.keeps_results) DEPTHFARM_RETURN_IF_ERROR(task.Output().status());  // before anything is loaded
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  MadeFiles made;
  const Status status = task.job().params.refine_rounds > 0 ? EmitRefined(task, made) : EmitLabels(task, made);
  DEPTHFARM_RETURN_IF_ERROR(status.WithContext(task.FrameName()));
  if (task.config.keeps_results) DEPTHFARM_RETURN_IF_ERROR(StoreFiles(task, made, outcome));
  outcome.files = std::move(made.files);
  return {};
}

bool TaskExecutor::ReuseFiles(const Task& task, TaskOutcome& outcome) {
  const Result<std::string> bundle = store_.Get(*task.spec.output_key);
  if (!bundle.ok()) return false;
  const Result<std::vector<BundledFile>> files = DecodeFileBundle(*bundle);
  outcome.artifact = store_.Find(*task.spec.output_key);
  if (!files.ok() || !outcome.artifact) {
    outcome.artifact.reset();
    store_.Drop(*task.spec.output_key);
    return false;
  }
  for (const BundledFile& file : *files)
    outcome.files.push_back({std::string(file.path), Sha256(file.bytes), file.bytes.size()});
  outcome.stats.reused = true;
  return true;
}

Status TaskExecutor::StoreFiles(const Task& task, const MadeFiles& made, TaskOutcome& outcome) {
  std::vector<BundledFile> files;
  for (std::size_t i = 0; i < made.files.size(); ++i) files.push_back({made.files[i].path, made.contents[i]});
  DEPTHFARM_ASSIGN_OR_RETURN(outcome.artifact, store_.Put(*task.spec.output_key, EncodeFileBundle(files)));
  return {};
}

Status TaskExecutor::Commit(const Task& task) {
  DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, task.Output());
  return folder.Commit(task.spec.staging, task.spec.files).WithContext(task.FrameName());
}

Status TaskExecutor::Manifest(const Task& task) {
  DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, task.Output());
  if (task.config.render) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string text,
                               FormatViewsManifest(task.config, task.spec.views, task.spec.files));
    return folder.Finish(text);
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest,
                             ManifestOf(task.config, task.spec.files, task.spec.picture_digests));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatDepthManifest(manifest));
  return folder.Finish(text);
}

template <typename T>
std::shared_ptr<const T> TaskExecutor::FindMade(const Task& task, const ArtifactKey& key, TaskOutcome& outcome) {
  // Others are given the file, whatever is in memory here. Of a damaged one they say that it is missing, and this task
  // is asked for again: it would be as often as it is answered from memory.
  if (!store_.Get(key).ok()) return nullptr;
  auto made = task.inputs.Find<T>(key);
  if (made != nullptr) outcome.artifact = store_.Find(key);
  outcome.stats.reused = outcome.artifact.has_value();
  return outcome.stats.reused ? made : nullptr;
}

template <typename T>
bool TaskExecutor::Reuse(const Task& task, TaskOutcome& outcome) {
  return FindMade<T>(task, *task.spec.output_key, outcome) != nullptr;
}

template <typename T>
Status TaskExecutor::Store(const Task& task, T object, TaskOutcome& outcome) {
  if (task.stop.stop_requested()) return Cancelled();
  DEPTHFARM_ASSIGN_OR_RETURN(outcome.artifact, store_.Put(*task.spec.output_key, Encode(object)));
  cache_.Put(*task.spec.output_key, std::make_shared<const T>(std::move(object)));
  return {};
}

}  // namespace depthfarm
