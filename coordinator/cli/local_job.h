#ifndef DEPTHFARM_COORDINATOR_CLI_LOCAL_JOB_H_
#define DEPTHFARM_COORDINATOR_CLI_LOCAL_JOB_H_

#include <string>

#include "common/base/status.h"
#include "coordinator/cli/arguments.h"
#include "coordinator/cli/job_request.h"
#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// A job that has ended on a farm of its own.
struct LocalJob {
  v1::JobStatus status;
  std::string started;      // UTC, ISO 8601
  double wall_seconds = 0;  // with starting and stopping the farm
  int workers = 0;          // at most
  int slots = 1;            // of each worker
  int threads = 1;          // that they share
  int respawns = 0;
  std::string log_tails;  // where it failed for another reason than its input: the ends of the farm's logs
};

// Starts a farm for this job alone, follows the job to its end with progress on stderr and stops the farm.
// Errors: kCancelled: interrupted (CatchInterruptions), the job was cancelled and its staging folder removed; else that
// of the farm. A job that failed is no error.
[[nodiscard]] Result<LocalJob> RunLocally(const JobRequest& request, const LocalFarmArguments& arguments);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_LOCAL_JOB_H_
