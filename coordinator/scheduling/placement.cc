#include "coordinator/scheduling/placement.h"

namespace depthfarm {

std::optional<Placement> ChoosePlacement(std::span<const TaskCandidate> tasks, std::span<const WorkerId> free_workers) {
  std::optional<Placement> best;
  std::uint64_t best_bytes = 0;
  for (const TaskCandidate& candidate : tasks) {
    for (const WorkerId worker : free_workers) {
      if (candidate.avoid.contains(worker) || candidate.full.contains(worker)) continue;
      const auto held = candidate.local_bytes.find(worker);
      const std::uint64_t bytes = held == candidate.local_bytes.end() ? 0 : held->second;
      if (best && bytes <= best_bytes) continue;
      best = Placement{candidate.task, worker};
      best_bytes = bytes;
    }
  }
  return best;
}

}  // namespace depthfarm
