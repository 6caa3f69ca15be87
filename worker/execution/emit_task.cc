// Emit and Render: the files of a job.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/digest/sha256.h"
#include "common/files/file_bundle.h"
#include "common/job/job_manifest.h"
#include "common/media/colour_map.h"
#include "common/media/depth_file.h"
#include "common/sequence/output_layout.h"
#include "worker/confidence/confidence.h"
#include "worker/estimation/estimation.h"
#include "worker/execution/executor_task.h"
#include "worker/refinement/refine.h"
#include "worker/rendering/source_views.h"

namespace depthfarm {
namespace {

// Leaves no depth where its confidence is less than `least`.
void MakeHoles(const ConfidenceMap& confidence, double least, Grid<std::uint16_t>& codes) {
  const double bound = least * kConfidenceScale;
  for (std::size_t i = 0; i < codes.size(); ++i)
    if (confidence.codes.values()[i] < bound) codes.values()[i] = 0;
}

}  // namespace

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
    return EmitDepth(task, job.views[v], codes, of_view);
  };
  DEPTHFARM_RETURN_IF_ERROR(EmitViews(task, emit_depth, made));
  if (!job.params.confidence) return {};
  const auto emit_confidence = [&](std::size_t v, MadeFiles& of_view) {
    const std::string& camera = job.views[v].camera.name;
    return EmitMap(task, camera, ConfidenceFileName(camera, task.SequenceFrame()), EncodeDepthPng(confidence[v]->codes),
                   of_view);
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
    return EmitDepth(task, job.views[v], codes, of_view);
  };
  return EmitViews(task, emit_depth, made);
}

Status TaskExecutor::EmitDepth(const Task& task, const JobView& view, const Grid<std::uint16_t>& codes,
                               MadeFiles& made) {
  const std::string& camera = view.camera.name;
  const Result<DepthCode> code = DepthCode::Create(view.own_range.z_near, view.own_range.z_far);
  if (!code.ok()) return code.status().WithContext("camera '" + camera + "'");
  return EmitMap(task, camera, DepthFileOf(task.job(), view, task.SequenceFrame()),
                 EncodeDepthFile(codes, *code, task.job().params.output_format), made);
}

Status TaskExecutor::EmitMap(const Task& task, const std::string& camera, const std::string& path,
                             Result<std::string> bytes, MadeFiles& made) {
  if (task.stop.stop_requested()) return Cancelled();
  if (!bytes.ok()) return bytes.status().WithContext("camera '" + camera + "'");
  return Stage(task, path, std::move(*bytes), made);
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

}  // namespace depthfarm
