#include "worker/execution/task_executor.h"

#include <chrono>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "common/job/job_manifest.h"
#include "worker/confidence/confidence.h"
#include "worker/confidence/confidence_codec.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/label_field_codec.h"
#include "worker/execution/executor_task.h"
#include "worker/execution/resource_usage.h"
#include "worker/execution/uploaded_files.h"
#include "worker/execution/views_manifest.h"
#include "worker/refinement/refine.h"
#include "worker/refinement/refined_view_codec.h"

namespace depthfarm {
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
  Result<LabelField> field = EstimateBlock(
      task.job(), analysis, references.has_value() ? &*references : nullptr,
      {.count = num_blocks, .index = task.spec.id.index},
      {.stop = task.stop, .stats = &stats, .floors = floors_.Of(task.job(), analysis), .threads = threads_});
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
      MergeLabels(task.job(), analysis, *labels[0], *labels[1],
                  {.stop = task.stop, .stats = &stats, .floors = floors_.Of(task.job(), analysis)});
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
  RefinementStats stats;
  Result<RefinedView> refined = round == 0
                                    ? StartOf(task.spec, job, task.inputs)
                                    : RefineView(job, view, round, task.inputs.ListedAnalyses(InputRole::kAnalysis),
                                                 task.inputs.ListedRefined(InputRole::kRefined), refining_,
                                                 {.stop = task.stop, .stats = &stats, .threads = threads_});
  if (!refined.ok()) return refined.status().WithContext(task.FrameName());
  outcome.stats.left_aside = stats.prior_left_aside;
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
