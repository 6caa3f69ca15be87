#ifndef DEPTHFARM_WORKER_MEDIA_CLI_VIRTUAL_VIEWS_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_VIRTUAL_VIEWS_H_

#include <vector>

#include "common/base/status.h"
#include "worker/media_cli/synthesize_command.h"
#include "worker/rendering/source_views.h"

namespace depthfarm {

// The pictures that the options ask for, in order. Errors: kInvalidArgument, as RunSynthesize.
[[nodiscard]] Result<std::vector<VirtualView>> PlanVirtualViews(const SynthesizeCommandOptions& options,
                                                                const SequenceWithDepth& input);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_VIRTUAL_VIEWS_H_
