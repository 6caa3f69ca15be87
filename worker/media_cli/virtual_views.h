#ifndef DEPTHFARM_WORKER_MEDIA_CLI_VIRTUAL_VIEWS_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_VIRTUAL_VIEWS_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "worker/media_cli/sequence_with_depth.h"
#include "worker/media_cli/synthesize_command.h"

namespace depthfarm {

// One picture to be made.
struct VirtualView {
  Camera camera;
  int frame = 0;             // of the sequence
  std::vector<int> sources;  // indices into SequenceWithDepth::views, at least one
  int number = 0;            // names its file
};

// The pictures that the options ask for, in order. Errors: kInvalidArgument, as RunSynthesize.
[[nodiscard]] Result<std::vector<VirtualView>> PlanVirtualViews(const SynthesizeCommandOptions& options,
                                                                const SequenceWithDepth& input);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_VIRTUAL_VIEWS_H_
