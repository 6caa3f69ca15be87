#include "coordinator/scheduling/gop_homes.h"

namespace depthfarm {

void GopHomes::Forget(WorkerId worker) {
  std::erase_if(homes_, [&](const auto& entry) { return entry.second == worker; });
}

std::optional<WorkerId> GopHomes::HomeOf(int gop) const {
  const auto home = homes_.find(gop);
  return home == homes_.end() ? std::nullopt : std::optional(home->second);
}

std::vector<int> GopHomes::Of(WorkerId worker) const {
  std::vector<int> gops;
  for (const auto& [gop, home] : homes_) {
    if (home == worker) gops.push_back(gop);
  }
  return gops;
}

}  // namespace depthfarm
