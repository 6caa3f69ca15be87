#include "coordinator/scheduling/placement.h"

#include "coordinator/planning/cost_model.h"

namespace depthfarm {
namespace {

constexpr double kLeftForEachRead = 6;  // seconds that are left, for each that is read

}  // namespace

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

bool IsHelpWorthReading(std::uint64_t missing_bytes, double seconds_left_of_gop) {
  return kLeftForEachRead * CostModel::SecondsToRead(missing_bytes) <= seconds_left_of_gop;
}

}  // namespace depthfarm
