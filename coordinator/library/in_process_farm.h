#ifndef DEPTHFARM_COORDINATOR_LIBRARY_IN_PROCESS_FARM_H_
#define DEPTHFARM_COORDINATOR_LIBRARY_IN_PROCESS_FARM_H_

#include <cstdint>
#include <filesystem>
#include <functional>

#include "common/base/status.h"
#include "coordinator/planning/job_plan.h"
#include "coordinator/scheduling/snapshot.h"

namespace depthfarm {

struct InProcessOptions {
  std::filesystem::path store;  // folder of the artifacts
  int slots = 1;                // tasks computed at a time, each on one thread
  std::uint64_t store_bytes = std::uint64_t{1} << 40;
  std::uint64_t memory_bytes = std::uint64_t{2} << 30;  // of decoded artifacts
  // Asked before anything is computed and several times a second, in the thread of the call; false cancels the job.
  // Told once more when the job is done, whatever it answers. Empty: not asked.
  std::function<bool(const JobSnapshot&)> go_on = {};
};

// Runs a job in this process: the scheduler and one worker of many slots, without sockets and processes. The result is
// how it ended; its files are those that the same job of a farm writes.
// Errors: kUnavailable: the store's folder cannot be used.
[[nodiscard]] Result<JobSnapshot> RunInProcess(const PlannedJob& job, const InProcessOptions& options);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_LIBRARY_IN_PROCESS_FARM_H_
