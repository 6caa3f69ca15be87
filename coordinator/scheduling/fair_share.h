#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_FAIR_SHARE_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_FAIR_SHARE_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/job/task.h"

namespace depthfarm {

// What a job has of the farm now.
struct JobShare {
  JobId job;
  int priority = 0;              // larger first
  int leases = 0;                // tasks in the hands of workers
  std::uint64_t last_grant = 0;  // number of its newest lease; 0: none yet
  bool ending = false;           // failed or cancelled: nothing but its Cleanup is left
};

// The order in which jobs are offered the next free worker: those that end, since their Cleanup takes a moment and
// frees the folder that somebody waits for; then by priority; of equal ones that with the fewest leases, then that
// which has waited longest since its last grant, then the oldest. So a job that is submitted behind others of its
// priority, however many and large, is served as soon as any worker is free, and all go on at the same pace.
[[nodiscard]] std::vector<JobId> FairOrder(std::vector<JobShare> jobs);

// How many of `wanted` ready tasks each of `num_jobs` jobs should have, so that any of them can be served: at least
// one.
[[nodiscard]] std::size_t ReadyShare(std::size_t wanted, std::size_t num_jobs);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_FAIR_SHARE_H_
