#include "coordinator/service/status_waits.h"

#include <algorithm>

namespace depthfarm {

std::vector<StatusWaits::Question> StatusWaits::TakeOf(JobId job) {
  std::vector<Question> taken;
  std::erase_if(waiting_, [&](auto& entry) {
    if (entry.second.job != job) return false;
    taken.push_back(std::move(entry.second));
    return true;
  });
  return taken;
}

std::vector<StatusWaits::Question> StatusWaits::TakeDue(TimePoint now) {
  std::vector<Question> taken;
  const auto end = waiting_.upper_bound(now);
  for (auto entry = waiting_.begin(); entry != end; ++entry) taken.push_back(std::move(entry->second));
  waiting_.erase(waiting_.begin(), end);
  return taken;
}

}  // namespace depthfarm
