#include "worker/media_cli/evaluate_targets.h"

#include <utility>

namespace depthfarm {

const Camera& CameraOf(const SequenceWithDepth& input, int view) {
  return input.views[static_cast<std::size_t>(view)].camera;
}

Status RestrictFrames(const EvaluateCommandOptions& options, SequenceWithDepth& input) {
  const std::string have = std::to_string(input.first_frame) + ":" + std::to_string(input.end_frame);
  const int end = options.end_frame < 0 ? input.end_frame : options.end_frame;
  // 0 is the default: "from the first frame that has depth" for a run over later frames.
  const int first = options.first_frame == 0 ? input.first_frame : options.first_frame;
  if (first < input.first_frame || end > input.end_frame || first >= end) {
    return InvalidArgument("frames " + std::to_string(first) + ":" + std::to_string(end) + " are asked for, " +
                           input.depth_dir + " has depth of " + have);
  }
  input.first_frame = first;
  input.end_frame = end;
  return {};
}

Result<std::vector<EvaluateTarget>> ChooseTargets(const EvaluateCommandOptions& options, const SequenceWithDepth& input,
                                                  std::vector<std::string>& notes) {
  if (options.view.empty() && !options.from.empty()) {
    return InvalidArgument("--from needs --view: which camera is to be synthesised from them?");
  }
  std::vector<EvaluateTarget> targets;
  if (options.view.empty()) {
    for (std::size_t i = 0; i < input.views.size(); ++i) {
      if (input.views[i].in_sequence->images.empty()) continue;
      EvaluateTarget target{static_cast<int>(i), SidesOf(input, static_cast<int>(i))};
      if (!target.from.empty()) targets.push_back(std::move(target));
    }
    if (targets.empty()) {
      notes.emplace_back("no camera with pictures lies between two that have depth: no virtual view is measured");
    }
    return targets;
  }
  EvaluateTarget target;
  DEPTHFARM_ASSIGN_OR_RETURN(target.view, FindView(input, options.view));
  for (const std::string& name : options.from) {
    DEPTHFARM_ASSIGN_OR_RETURN(const int source, FindView(input, name));
    if (source == target.view) return InvalidArgument("camera '" + name + "' is both --view and one of --from");
    if (input.views[static_cast<std::size_t>(source)].depth == nullptr) {
      return InvalidArgument("there is no depth of camera '" + name + "' in " + input.depth_dir);
    }
    target.from.push_back(source);
  }
  if (options.from.empty()) {
    target.from = SidesOf(input, target.view);
    if (target.from.empty()) {
      return InvalidArgument("camera '" + options.view +
                             "' doesn't lie between two that have depth: name its sources with --from");
    }
  }
  targets.push_back(std::move(target));
  return targets;
}

Result<std::vector<SourceView>> SourcesOf(const SequenceWithDepth& input, const EvaluateTarget& target, bool exact,
                                          FrameWithDepth& frame) {
  std::vector<SourceView> sources;
  for (const int view : target.from) {
    SourceView source;
    source.camera = CameraOf(input, view);
    DEPTHFARM_ASSIGN_OR_RETURN(source.picture, frame.Picture(view));
    if (exact) {
      DEPTHFARM_ASSIGN_OR_RETURN(const GroundTruthFrame* truth, frame.Truth(view));
      if (truth == nullptr) return std::vector<SourceView>{};
      source.depth = &truth->depth;
    } else {
      DEPTHFARM_ASSIGN_OR_RETURN(source.depth, frame.Depth(view));
    }
    sources.push_back(source);
  }
  return sources;
}

}  // namespace depthfarm
