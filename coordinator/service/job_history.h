#ifndef DEPTHFARM_COORDINATOR_SERVICE_JOB_HISTORY_H_
#define DEPTHFARM_COORDINATOR_SERVICE_JOB_HISTORY_H_

#include <cstddef>
#include <map>
#include <string>

#include "coordinator/scheduling/snapshot.h"

namespace depthfarm {

// The last jobs that ended, so that their status can still be asked for.
class JobHistory {
 public:
  explicit JobHistory(std::size_t max_jobs) : max_jobs_(max_jobs) {}
  // Forgets the oldest ones beyond the bound.
  void Add(const JobSnapshot& job);
  // Null when it did not end, or long ago.
  [[nodiscard]] const JobSnapshot* Find(JobId id) const;
  [[nodiscard]] const std::map<JobId, JobSnapshot>& jobs() const { return jobs_; }

 private:
  std::size_t max_jobs_;
  std::map<JobId, JobSnapshot> jobs_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_JOB_HISTORY_H_
