#include "worker/optimization/labelling_problem.h"

#include <algorithm>
#include <cstdlib>

namespace depthfarm {

int LevelIndex(const LabellingProblem& problem, Level level) {
  const auto found = std::lower_bound(problem.levels.begin(), problem.levels.end(), level);
  if (found == problem.levels.end() || *found != level) return -1;
  return static_cast<int>(found - problem.levels.begin());
}

std::int64_t TotalEnergy(const LabellingProblem& problem, const std::vector<Level>& labels) {
  std::int64_t energy = 0;
  for (const SmoothnessLink& link : problem.smoothness) {
    energy += static_cast<std::int64_t>(link.beta) * std::abs(int{labels[link.first]} - int{labels[link.second]});
  }
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    const int level_index = LevelIndex(problem, labels[node]);
    if (level_index < 0) continue;
    const MatchLink* matches = problem.Matches(static_cast<std::size_t>(level_index), node);
    for (int slot = 0; slot < problem.matches_per_node; ++slot) {
      if (matches[slot].reward != 0 && labels[matches[slot].target] == labels[node])
        energy -= matches[slot].RewardUnits();
    }
  }
  return energy;
}

void WinnerTakesAll(const LabellingProblem& problem, std::vector<Level>& labels) {
  std::vector<std::int32_t> best(problem.num_nodes, -1);
  for (std::size_t level_index = 0; level_index < problem.levels.size(); ++level_index) {
    for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
      if (problem.fixed[node] != 0) continue;
      const MatchLink* matches = problem.Matches(level_index, node);
      std::int32_t reward = 0;
      for (int slot = 0; slot < problem.matches_per_node; ++slot) reward += matches[slot].reward;
      if (reward > best[node]) {
        best[node] = reward;
        labels[node] = problem.levels[level_index];
      }
    }
  }
}

}  // namespace depthfarm
