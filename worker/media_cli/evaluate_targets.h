#ifndef DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_TARGETS_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_TARGETS_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/synthesis/source_view.h"
#include "worker/media_cli/evaluate_command.h"
#include "worker/rendering/sequence_with_depth.h"

namespace depthfarm {

// A view to synthesise; indices into SequenceWithDepth::views.
struct EvaluateTarget {
  int view = 0;
  std::vector<int> from;
};

[[nodiscard]] const Camera& CameraOf(const SequenceWithDepth& input, int view);

// Takes the frames that are asked for. kInvalidArgument: there is no depth of them.
[[nodiscard]] Status RestrictFrames(const EvaluateCommandOptions& options, SequenceWithDepth& input);

// The view that is asked for, or every one between two others; `notes` says so if there is none.
[[nodiscard]] Result<std::vector<EvaluateTarget>> ChooseTargets(const EvaluateCommandOptions& options,
                                                                const SequenceWithDepth& input,
                                                                std::vector<std::string>& notes);

// The sources of a target in one frame, with estimated or exact depth. Empty if the exact depth of one isn't known.
[[nodiscard]] Result<std::vector<SourceView>> SourcesOf(const SequenceWithDepth& input, const EvaluateTarget& target,
                                                        bool exact, FrameWithDepth& frame);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_TARGETS_H_
