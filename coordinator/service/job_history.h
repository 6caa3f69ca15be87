#ifndef DEPTHFARM_COORDINATOR_SERVICE_JOB_HISTORY_H_
#define DEPTHFARM_COORDINATOR_SERVICE_JOB_HISTORY_H_

#include <cstddef>
#include <deque>
#include <map>

#include "common/job/task.h"
#include "common/wire/envelope.h"

namespace depthfarm {

// The last jobs that ended, so that their status can still be asked for.
class JobHistory {
 public:
  // `max_jobs`: at least 1.
  explicit JobHistory(std::size_t max_jobs) : max_jobs_(max_jobs) {}
  // Forgets those beyond the bound that ended first.
  void Add(const v1::JobStatus& job);
  // A job that goes on.
  void Remove(JobId id);
  // Null when it did not end, or long ago.
  [[nodiscard]] const v1::JobStatus* Find(JobId id) const;
  [[nodiscard]] const std::map<JobId, v1::JobStatus>& jobs() const { return jobs_; }

 private:
  std::size_t max_jobs_;
  std::map<JobId, v1::JobStatus> jobs_;
  std::deque<JobId> order_;  // in which they ended
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_JOB_HISTORY_H_
