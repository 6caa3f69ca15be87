#include "worker/optimization/expansion.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace depthfarm {
namespace {

int Distance(Level a, Level b) { return std::abs(int{a} - int{b}); }

int DistanceFromInterval(Level alpha, Level a, Level b) {
  const Level low = std::min(a, b);
  const Level high = std::max(a, b);
  if (alpha < low) return low - alpha;
  return alpha > high ? alpha - high : 0;
}

}  // namespace

Expansion::Expansion(const LabellingProblem& problem, std::vector<Level>& labels)
    : problem_(problem),
      labels_(labels),
      held_(static_cast<std::size_t>(problem.num_nodes) * static_cast<std::size_t>(problem.matches_per_node)),
      terminal_(problem.num_nodes) {
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    const int level_index = LevelIndex(problem, labels[node]);
    if (level_index >= 0) HoldMatches(node, problem.Matches(static_cast<std::size_t>(level_index), node));
  }
  energy_ = TotalEnergy(problem, labels);
}

void Expansion::HoldMatches(NodeIndex node, const MatchLink* matches) {
  const auto width = static_cast<std::size_t>(problem_.matches_per_node);
  std::copy(matches, matches + width, held_.begin() + static_cast<std::ptrdiff_t>(node * width));
}

void Expansion::AddSmoothness(Level alpha) {
  for (const SmoothnessLink& link : problem_.smoothness) {
    const Level s = labels_[link.first];
    const Level t = labels_[link.second];
    const bool s_constant = IsConstant(link.first, alpha);
    const bool t_constant = IsConstant(link.second, alpha);
    if (s_constant && t_constant) continue;
    const std::int64_t beta = link.beta;
    const std::int64_t keep_both = beta * Distance(s, t);
    if (t_constant) {
      terminal_[link.first] += beta * Distance(alpha, t) - keep_both;
    } else if (s_constant) {
      terminal_[link.second] += beta * Distance(s, alpha) - keep_both;
    } else {
      const std::int64_t apart = beta * DistanceFromInterval(alpha, s, t);
      terminal_[link.first] += beta * Distance(alpha, t) - keep_both - apart;
      terminal_[link.second] += beta * Distance(s, alpha) - keep_both - apart;
      if (apart != 0) flow_.AddEdge(link.first, link.second, static_cast<std::int32_t>(apart));
    }
  }
}

// A constant node's reward depends only on its target: it is gained if the target takes alpha, or lost if it leaves.
void Expansion::AddMatchesOfConstant(NodeIndex node, const MatchLink* at_alpha, Level alpha) {
  const bool holds_alpha = labels_[node] == alpha;
  const auto width = static_cast<std::size_t>(problem_.matches_per_node);
  const MatchLink* held = held_.data() + node * width;
  for (std::size_t slot = 0; slot < width; ++slot) {
    const MatchLink& match = holds_alpha ? at_alpha[slot] : held[slot];
    if (match.reward == 0 || IsConstant(match.target, alpha)) continue;
    if (holds_alpha) {
      terminal_[match.target] -= match.RewardUnits();
    } else if (labels_[match.target] == labels_[node]) {
      terminal_[match.target] += match.RewardUnits();
    }
  }
}

void Expansion::AddMatchesOfFree(NodeIndex node, const MatchLink* at_alpha, Level alpha) {
  const auto width = static_cast<std::size_t>(problem_.matches_per_node);
  const MatchLink* held = held_.data() + node * width;
  for (std::size_t slot = 0; slot < width; ++slot) {
    const MatchLink& keep = held[slot];
    if (keep.reward != 0 && labels_[keep.target] == labels_[node]) {
      const std::int32_t reward = keep.RewardUnits();
      if (IsConstant(keep.target, alpha)) {
        terminal_[node] += reward;  // lost when the node leaves
      } else {
        terminal_[node] += reward / 2;
        terminal_[keep.target] += reward / 2;
        flow_.AddEdge(node, keep.target, reward / 2);
      }
    }
    const MatchLink& take = at_alpha[slot];
    if (take.reward == 0) continue;
    const std::int32_t reward = take.RewardUnits();
    if (labels_[take.target] == alpha) {
      terminal_[node] -= reward;
    } else if (problem_.fixed[take.target] == 0) {
      terminal_[node] -= reward / 2;
      terminal_[take.target] -= reward / 2;
      flow_.AddEdge(node, take.target, reward / 2);
    }
  }
}

void Expansion::AddMatches(std::size_t level_index, Level alpha) {
  for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
    const MatchLink* at_alpha = problem_.Matches(level_index, node);
    if (IsConstant(node, alpha)) {
      AddMatchesOfConstant(node, at_alpha, alpha);
    } else {
      AddMatchesOfFree(node, at_alpha, alpha);
    }
  }
}

std::int64_t Expansion::Expand(std::size_t level_index) {
  const Level alpha = problem_.levels[level_index];
  flow_.Reset(problem_.num_nodes);
  std::fill(terminal_.begin(), terminal_.end(), 0);
  AddSmoothness(alpha);
  AddMatches(level_index, alpha);

  // Least E - E(keep all) = (sum of the negative linear coefficients) + maximum flow.
  std::int64_t delta = 0;
  for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
    if (terminal_[node] < 0) delta += terminal_[node];
    if (terminal_[node] != 0) flow_.AddTerminal(node, -terminal_[node]);
  }
  if (delta == 0) return 0;
  delta += flow_.Solve();
  if (delta == 0) return 0;
  for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
    if (!flow_.InSourceSide(node)) continue;
    labels_[node] = alpha;
    HoldMatches(node, problem_.Matches(level_index, node));
  }
  energy_ += delta;
  return delta;
}

ExpansionSummary ExpandToConvergence(const LabellingProblem& problem, std::vector<Level>& labels, int max_sweeps,
                                     const std::stop_token& stop) {
  Expansion expansion(problem, labels);
  ExpansionSummary summary;
  const std::size_t num_levels = problem.levels.size();
  std::vector<std::int64_t> tried_at(num_levels, -1);  // number of moves made when the level was last tried
  bool lowered = true;
  while (lowered && (max_sweeps == 0 || summary.sweeps < max_sweeps)) {
    lowered = false;
    for (std::size_t step = 0; step < num_levels; ++step) {
      if (stop.stop_requested()) {
        summary.cancelled = true;
        return summary;
      }
      const std::size_t level_index = summary.sweeps % 2 == 0 ? step : num_levels - 1 - step;
      if (tried_at[level_index] == summary.moves) continue;
      if (expansion.Expand(level_index) < 0) {
        ++summary.moves;
        lowered = true;
      }
      tried_at[level_index] = summary.moves;
    }
    ++summary.sweeps;
  }
  summary.energy = expansion.energy();
  return summary;
}

}  // namespace depthfarm
