#include "worker/optimization/labelling_problem.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>

#include "common/base/parallel.h"

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

std::int64_t TotalEnergy(const LabellingProblem& problem, const std::vector<Level>& labels, int threads) {
  constexpr std::size_t kAtOnce = 1U << 14U;  // links or nodes, of a thread
  std::atomic<std::int64_t> energy = 0;
  ParallelForPieces(problem.smoothness.size(), kAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    std::int64_t sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const SmoothnessLink& link = problem.smoothness[i];
      sum += static_cast<std::int64_t>(link.beta) * std::abs(int{labels[link.first]} - int{labels[link.second]});
    }
    energy += sum;
  });
  ParallelForPieces(problem.num_nodes, kAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    std::int64_t sum = 0;
    for (auto node = static_cast<NodeIndex>(begin); node < end; ++node) {
      const int level = LevelIndex(problem, labels[node]);
      if (level < 0) continue;
      for (const MatchTable::Match& match : problem.matches.At(node, static_cast<std::size_t>(level))) {
        if (labels[match.target] == labels[node]) sum += match.RewardUnits();
      }
    }
    energy -= sum;
  });
  return energy;
}

void WinnerTakesAll(const LabellingProblem& problem, std::vector<Level>& labels) {
  struct Best {
    std::size_t level = 0;
    std::int32_t reward = 0;
    std::size_t last_level = 0;  // that was seen, and its rewards so far
    std::int32_t sum = 0;
  };
  std::vector<Best> best_of(problem.num_nodes);
  problem.matches.ForEachOf(0, problem.num_nodes, [&](NodeIndex node, const MatchTable::Match& match) {
    Best& best = best_of[node];
    if (match.level != best.last_level) best.sum = 0;
    best.last_level = match.level;
    best.sum += match.reward;
    if (best.sum > best.reward) {
      best.reward = best.sum;
      best.level = match.level;
    }
  });
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    if (problem.fixed[node] == 0) labels[node] = problem.levels[best_of[node].level];
  }
}

}  // namespace depthfarm
