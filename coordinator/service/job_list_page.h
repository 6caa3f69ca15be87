#ifndef DEPTHFARM_COORDINATOR_SERVICE_JOB_LIST_PAGE_H_
#define DEPTHFARM_COORDINATOR_SERVICE_JOB_LIST_PAGE_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "common/job/task.h"
#include "common/wire/envelope.h"

namespace depthfarm {

// One answer to ListJobs: jobs by their ids, at most as many as were asked for, 1,000 and 4 MiB. Who asks for no number
// knows no pages and gets all jobs at once.
class JobListPage {
 public:
  explicit JobListPage(const v1::ListJobs& request);

  // Jobs of other pages need not be added.
  [[nodiscard]] bool IsAfter(JobId id) const { return id.value() > after_; }
  // False when there is no room: then the page ends with the one before. Each id is higher than the last.
  [[nodiscard]] bool Add(v1::JobStatus job);
  [[nodiscard]] v1::JobList Take() && { return std::move(list_); }

 private:
  std::uint64_t after_;
  std::size_t max_jobs_ = std::numeric_limits<std::size_t>::max();
  std::size_t max_bytes_ = std::numeric_limits<std::size_t>::max();
  std::size_t bytes_ = 0;
  v1::JobList list_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_JOB_LIST_PAGE_H_
