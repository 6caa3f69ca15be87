#include "worker/optimization/labelling_problem.h"

#include <algorithm>
#include <cstdlib>

namespace depthfarm {

std::vector<std::uint16_t> BandsOf(const LabellingProblem& problem, int parts) {
  std::vector<std::uint16_t> bands(problem.num_nodes, 0);
  std::vector<NodeIndex> begins = problem.view_begin;
  if (begins.empty()) begins.push_back(0);
  begins.push_back(problem.num_nodes);
  for (std::size_t view = 0; view + 1 < begins.size(); ++view) {
    const std::uint64_t nodes = begins[view + 1] - begins[view];
    for (std::uint64_t i = 0; i < nodes; ++i)
      bands[begins[view] + i] = static_cast<std::uint16_t>(i * static_cast<std::uint64_t>(parts) / nodes);
  }
  return bands;
}

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
    const int level = LevelIndex(problem, labels[node]);
    if (level < 0) continue;
    for (const MatchTable::Match& match : problem.matches.At(node, static_cast<std::size_t>(level))) {
      if (labels[match.target] == labels[node]) energy -= match.RewardUnits();
    }
  }
  return energy;
}

void WinnerTakesAll(const LabellingProblem& problem, std::vector<Level>& labels) {
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    if (problem.fixed[node] != 0) continue;
    std::size_t best_level = 0;
    std::int32_t best = 0;
    std::size_t level = 0;
    std::int32_t reward = 0;
    for (const MatchTable::Match& match : problem.matches.Of(node)) {
      if (match.level != level) reward = 0;
      level = match.level;
      reward += match.reward;
      if (reward > best) {
        best = reward;
        best_level = level;
      }
    }
    labels[node] = problem.levels[best_level];
  }
}

}  // namespace depthfarm
