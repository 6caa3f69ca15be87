#include "coordinator/scheduling/fair_share.h"

#include <algorithm>
#include <tuple>

namespace depthfarm {

std::vector<JobId> FairOrder(std::vector<JobShare> jobs) {
  std::ranges::sort(jobs, {}, [](const JobShare& share) {
    return std::tuple(!share.ending, -std::int64_t{share.priority}, share.leases, share.last_grant, share.job);
  });
  std::vector<JobId> order;
  order.reserve(jobs.size());
  for (const JobShare& share : jobs) order.push_back(share.job);
  return order;
}

std::size_t ReadyShare(std::size_t wanted, std::size_t num_jobs) {
  return num_jobs == 0 ? wanted : std::max<std::size_t>(1, (wanted + num_jobs - 1) / num_jobs);
}

}  // namespace depthfarm
