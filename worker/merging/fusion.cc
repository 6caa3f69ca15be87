#include "worker/merging/fusion.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "worker/optimization/max_flow.h"

namespace depthfarm {
namespace {

std::int64_t Variation(const SmoothnessLink& link, Level s, Level t) {
  return static_cast<std::int64_t>(link.beta) * std::abs(int{s} - int{t});
}

class FusionCut {
 public:
  explicit FusionCut(const FusionProblem& problem) : problem_(problem), terminal_(problem.num_nodes) {
    flow_.Reset(problem.num_nodes);
  }

  std::vector<std::uint8_t> Solve() {
    for (const SmoothnessLink& link : *problem_.smoothness) AddSmoothness(link);
    for (const int map : {0, 1}) AddMatches(map);
    AddMatchesOfConstants();
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
      if (terminal_[node] != 0) flow_.AddTerminal(node, -terminal_[node]);
    }
    flow_.Solve();
    std::vector<std::uint8_t> choice(problem_.num_nodes);
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) choice[node] = flow_.InSourceSide(node) ? 1 : 0;
    return choice;
  }

 private:
  // A term with values E00, E01 (s first map, t second), E10, E11, in the symmetric normal form of expansions.
  void AddPair(NodeIndex s, NodeIndex t, std::int64_t e00, std::int64_t e01, std::int64_t e10, std::int64_t e11) {
    const std::int64_t excess = e00 + e11 - e01 - e10;
    if (excess > 0) {  // even: all four are
      e01 += excess / 2;
      e10 += excess / 2;
    }
    const std::int64_t apart = (e01 + e10 - e00 - e11) / 2;
    terminal_[s] += e10 - e00 - apart;
    terminal_[t] += e01 - e00 - apart;
    if (apart != 0) flow_.AddEdge(s, t, static_cast<std::int32_t>(apart));
  }

  void AddSmoothness(const SmoothnessLink& link) {
    const NodeIndex s = link.first;
    const NodeIndex t = link.second;
    const std::vector<Level>& a = problem_.labels[0];
    const std::vector<Level>& b = problem_.labels[1];
    AddPair(s, t, Variation(link, a[s], a[t]), Variation(link, a[s], b[t]), Variation(link, b[s], a[t]),
            Variation(link, b[s], b[t]));
  }

  // The rewards of nodes that take their level of `map`.
  void AddMatches(int map) {
    const auto width = static_cast<std::size_t>(problem_.matches_per_node);
    const std::vector<Level>& own = problem_.labels[map];
    const std::vector<Level>& other = problem_.labels[1 - map];
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
      if (own[node] == other[node]) continue;  // a constant: AddMatchesOfConstants
      for (std::size_t slot = 0; slot < width; ++slot) {
        const MatchLink& match = problem_.matches[map][node * width + slot];
        if (match.reward == 0) continue;
        if (own[match.target] != own[node]) continue;  // agreement across the maps: left out, see the header
        const std::int64_t reward = match.RewardUnits();
        if (other[match.target] == own[node]) {
          terminal_[node] += map == 0 ? reward : -reward;  // the target agrees whatever it takes
        } else if (map == 0) {
          AddPair(node, match.target, -reward, 0, 0, 0);
        } else {
          AddPair(node, match.target, 0, 0, 0, -reward);
        }
      }
    }
  }

  // A node with one level in both maps (unchanged segments) is rewarded by what its target takes alone.
  void AddMatchesOfConstants() {
    const auto width = static_cast<std::size_t>(problem_.matches_per_node);
    const std::vector<Level>& a = problem_.labels[0];
    const std::vector<Level>& b = problem_.labels[1];
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
      if (a[node] != b[node]) continue;
      for (std::size_t slot = 0; slot < width; ++slot) {
        const MatchLink& match = problem_.matches[0][node * width + slot];
        const std::int64_t reward = match.RewardUnits();
        const bool agrees_in_first = a[match.target] == a[node];
        const bool agrees_in_second = b[match.target] == a[node];
        if (reward == 0 || agrees_in_first == agrees_in_second) continue;
        terminal_[match.target] += agrees_in_first ? reward : -reward;
      }
    }
  }

  const FusionProblem& problem_;
  std::vector<std::int64_t> terminal_;
  MaxFlow flow_;
};

}  // namespace

std::int64_t FusionEnergy(const FusionProblem& problem, const std::vector<std::uint8_t>& choice) {
  const auto label = [&](NodeIndex node) { return problem.labels[choice[node]][node]; };
  std::int64_t energy = 0;
  for (const SmoothnessLink& link : *problem.smoothness)
    energy += Variation(link, label(link.first), label(link.second));
  const auto width = static_cast<std::size_t>(problem.matches_per_node);
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    for (std::size_t slot = 0; slot < width; ++slot) {
      const MatchLink& match = problem.matches[choice[node]][node * width + slot];
      if (match.reward != 0 && label(match.target) == label(node)) energy -= match.RewardUnits();
    }
  }
  return energy;
}

FusionResult Fuse(const FusionProblem& problem) {
  FusionResult result;
  result.from_second = FusionCut(problem).Solve();
  result.labels.resize(problem.num_nodes);
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    result.labels[node] = problem.labels[result.from_second[node]][node];
  }
  result.energy = FusionEnergy(problem, result.from_second);
  result.first_energy = FusionEnergy(problem, std::vector<std::uint8_t>(problem.num_nodes, 0));
  result.second_energy = FusionEnergy(problem, std::vector<std::uint8_t>(problem.num_nodes, 1));
  return result;
}

}  // namespace depthfarm
