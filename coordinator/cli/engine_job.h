#ifndef DEPTHFARM_COORDINATOR_CLI_ENGINE_JOB_H_
#define DEPTHFARM_COORDINATOR_CLI_ENGINE_JOB_H_

#include "common/base/status.h"
#include "coordinator/cli/arguments.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/local_job.h"

namespace depthfarm {

// Brings a cluster up for this job alone, follows the job to its end with progress on stderr and takes the cluster
// down, however it ended. The state folder is removed, unless it was named.
// Errors: kCancelled: interrupted (CatchInterruptions), the job was cancelled; else that of the cluster. A job that
// failed is no error.
[[nodiscard]] Result<LocalJob> RunOnEngine(const JobRequest& request, const EngineArguments& arguments, int threads);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_ENGINE_JOB_H_
