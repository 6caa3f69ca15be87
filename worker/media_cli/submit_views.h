#ifndef DEPTHFARM_WORKER_MEDIA_CLI_SUBMIT_VIEWS_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_SUBMIT_VIEWS_H_

#include <cstdint>
#include <string>

#include "common/base/status.h"
#include "coordinator/client/client.h"
#include "worker/media_cli/synthesize_command.h"

namespace depthfarm {

// The job that renders what RunSynthesize would, as PNG pictures: DIR/views/0000.png, ... and DIR/views.json.
// Everything is planned and looked at here, so that the job will not fail for a wrong option; paths become absolute.
// Errors  kInvalidArgument: as RunSynthesize; an output that is not a folder, or holds views that no job made.
[[nodiscard]] Result<JobSubmission> PlanViewsJob(const SynthesizeCommandOptions& options, const std::string& name,
                                                 int priority);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_SUBMIT_VIEWS_H_
