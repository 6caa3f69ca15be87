#ifndef DEPTHFARM_COORDINATOR_CLI_JOB_ON_FARM_H_
#define DEPTHFARM_COORDINATOR_CLI_JOB_ON_FARM_H_

#include <functional>
#include <string>

#include "common/base/status.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/client/client.h"
#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// A farm that a job has for itself.
struct OwnFarm {
  CoordinatorTarget target;
  std::function<bool()> ended;         // no question will be answered any more
  std::function<Status()> look_after;  // called again and again while the job runs; its failure ends the job
};

// Submits the job and follows it to its end with progress on stderr. Status: the farm failed, or the run was
// interrupted: then the job was cancelled and what it wrote tidied up, as far as the farm still could.
[[nodiscard]] Result<v1::JobStatus> RunOnFarm(const OwnFarm& farm, const JobRequest& request);

// After the end of the farm: nothing runs any more, so what a killed worker left half-written in the output folder can
// go.
void RemoveStaging(const std::string& output_dir);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_JOB_ON_FARM_H_
