#include "worker/optimization/expansion.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>

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
      in_graph_(problem.num_nodes),
      held_(static_cast<std::size_t>(problem.num_nodes) * static_cast<std::size_t>(problem.matches_per_node)) {
  const auto is_free = [&](NodeIndex node) { return problem.fixed[node] == 0; };
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    in_graph_[node] = static_cast<MaxFlow::Node>(free_.size());
    if (is_free(node)) free_.push_back(node);
    const int level_index = LevelIndex(problem, labels[node]);
    if (level_index < 0) continue;
    const MatchLink* matches = problem.Matches(static_cast<std::size_t>(level_index), node);
    HoldMatches(node, matches);
    const auto rewards_free = [&](const MatchLink& match) { return match.reward != 0 && is_free(match.target); };
    if (!is_free(node) && std::any_of(matches, matches + problem.matches_per_node, rewards_free)) {
      rewarding_.push_back(node);
    }
  }
  std::copy_if(problem.smoothness.begin(), problem.smoothness.end(), std::back_inserter(smoothness_),
               [&](const SmoothnessLink& link) { return is_free(link.first) || is_free(link.second); });
  terminal_.resize(free_.size());
  energy_ = TotalEnergy(problem, labels);
}

void Expansion::HoldMatches(NodeIndex node, const MatchLink* matches) {
  const auto width = static_cast<std::size_t>(problem_.matches_per_node);
  std::copy(matches, matches + width, held_.begin() + static_cast<std::ptrdiff_t>(node * width));
}

void Expansion::AddSmoothness(Level alpha) {
  for (const SmoothnessLink& link : smoothness_) {
    const Level s = labels_[link.first];
    const Level t = labels_[link.second];
    const bool s_constant = IsConstant(link.first, alpha);
    const bool t_constant = IsConstant(link.second, alpha);
    if (s_constant && t_constant) continue;
    const std::int64_t beta = link.beta;
    const std::int64_t keep_both = beta * Distance(s, t);
    if (t_constant) {
      Terminal(link.first) += beta * Distance(alpha, t) - keep_both;
    } else if (s_constant) {
      Terminal(link.second) += beta * Distance(s, alpha) - keep_both;
    } else {
      const std::int64_t apart = beta * DistanceFromInterval(alpha, s, t);
      Terminal(link.first) += beta * Distance(alpha, t) - keep_both - apart;
      Terminal(link.second) += beta * Distance(s, alpha) - keep_both - apart;
      if (apart != 0) flow_.AddEdge(InGraph(link.first), InGraph(link.second), static_cast<std::int32_t>(apart));
    }
  }
}

// A constant node's reward depends only on its target: it is gained if the target takes alpha, or lost if it leaves.
void Expansion::AddMatchesOfConstant(NodeIndex node, Level alpha) {
  const bool holds_alpha = labels_[node] == alpha;
  const auto width = static_cast<std::size_t>(problem_.matches_per_node);
  const MatchLink* held = held_.data() + node * width;
  for (std::size_t slot = 0; slot < width; ++slot) {
    const MatchLink& match = held[slot];
    if (match.reward == 0 || IsConstant(match.target, alpha)) continue;
    if (holds_alpha) {
      Terminal(match.target) -= match.RewardUnits();
    } else if (labels_[match.target] == labels_[node]) {
      Terminal(match.target) += match.RewardUnits();
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
        Terminal(node) += reward;  // lost when the node leaves
      } else {
        Terminal(node) += reward / 2;
        Terminal(keep.target) += reward / 2;
        flow_.AddEdge(InGraph(node), InGraph(keep.target), reward / 2);
      }
    }
    const MatchLink& take = at_alpha[slot];
    if (take.reward == 0) continue;
    const std::int32_t reward = take.RewardUnits();
    if (labels_[take.target] == alpha) {
      Terminal(node) -= reward;
    } else if (problem_.fixed[take.target] == 0) {
      Terminal(node) -= reward / 2;
      Terminal(take.target) -= reward / 2;
      flow_.AddEdge(InGraph(node), InGraph(take.target), reward / 2);
    }
  }
}

void Expansion::AddMatches(std::size_t level_index, Level alpha) {
  for (const NodeIndex node : free_) {
    if (labels_[node] == alpha) {
      AddMatchesOfConstant(node, alpha);
    } else {
      AddMatchesOfFree(node, problem_.Matches(level_index, node), alpha);
    }
  }
  for (const NodeIndex node : rewarding_) AddMatchesOfConstant(node, alpha);
}

std::int64_t Expansion::Expand(std::size_t level_index) {
  const Level alpha = problem_.levels[level_index];
  flow_.Reset(static_cast<MaxFlow::Node>(free_.size()));
  std::fill(terminal_.begin(), terminal_.end(), 0);
  AddSmoothness(alpha);
  AddMatches(level_index, alpha);

  // Least E - E(keep all) = (sum of the negative linear coefficients) + maximum flow.
  std::int64_t delta = 0;
  for (std::size_t i = 0; i < terminal_.size(); ++i) {
    if (terminal_[i] < 0) delta += terminal_[i];
    if (terminal_[i] != 0) flow_.AddTerminal(static_cast<MaxFlow::Node>(i), -terminal_[i]);
  }
  if (delta == 0) return 0;
  delta += flow_.Solve();
  if (delta == 0) return 0;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (!flow_.InSourceSide(static_cast<MaxFlow::Node>(i))) continue;
    labels_[free_[i]] = alpha;
    HoldMatches(free_[i], problem_.Matches(level_index, free_[i]));
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
