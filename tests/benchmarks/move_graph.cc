#include "tests/benchmarks/move_graph.h"

#include <algorithm>
#include <cstdlib>

namespace depthfarm::benchmarks {
namespace {

// Sums the terms of a move: x = 1 takes alpha, x = 0 keeps.
class MoveBuilder {
 public:
  MoveBuilder(const LabellingProblem& problem, const std::vector<Level>& labels, Level alpha)
      : problem_(problem), labels_(labels), alpha_(alpha), linear_(problem.num_nodes, 0) {}

  void AddSmoothness(const SmoothnessLink& link) {
    Add(link.first, link.second, [&](Level s, Level t) { return std::int64_t{link.beta} * std::abs(int{s} - int{t}); });
  }

  void AddMatch(NodeIndex node, const MatchTable::Match& match, Level level) {
    if (match.reward == 0) return;
    Add(node, match.target,
        [&](Level s, Level t) { return s == level && t == level ? -std::int64_t{match.RewardUnits()} : 0; });
  }

  [[nodiscard]] MoveGraph Graph() && {
    for (const std::int64_t coefficient : linear_) graph_.constant += std::min<std::int64_t>(coefficient, 0);
    graph_.terminal.resize(linear_.size());
    std::transform(linear_.begin(), linear_.end(), graph_.terminal.begin(), [](std::int64_t c) { return -c; });
    return std::move(graph_);
  }

 private:
  [[nodiscard]] Level LabelOf(NodeIndex node, int x) const {
    return x == 1 && problem_.fixed[node] == 0 ? alpha_ : labels_[node];
  }

  // E00 + (E10 - E00 - k) xs + (E01 - E00 - k) xt + k |xs - xt|.
  template <typename Energy>
  void Add(NodeIndex s, NodeIndex t, const Energy& energy) {
    std::int64_t value[2][2];
    for (const int xs : {0, 1})
      for (const int xt : {0, 1}) value[xs][xt] = energy(LabelOf(s, xs), LabelOf(t, xt));
    const std::int64_t k = (value[0][1] + value[1][0] - value[0][0] - value[1][1]) / 2;
    linear_[s] += value[1][0] - value[0][0] - k;
    linear_[t] += value[0][1] - value[0][0] - k;
    if (k != 0) graph_.edges.push_back({s, t, static_cast<std::int32_t>(k)});
  }

  const LabellingProblem& problem_;
  const std::vector<Level>& labels_;
  Level alpha_;
  std::vector<std::int64_t> linear_;
  MoveGraph graph_;
};

}  // namespace

MoveGraph GraphOfMove(const LabellingProblem& problem, const std::vector<Level>& labels, std::size_t level_index) {
  const Level alpha = problem.levels[level_index];
  MoveBuilder builder(problem, labels, alpha);
  for (const SmoothnessLink& link : problem.smoothness) builder.AddSmoothness(link);
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    const int held = LevelIndex(problem, labels[node]);
    if (held >= 0 && labels[node] != alpha) {
      for (const MatchTable::Match& match : problem.matches.At(node, static_cast<std::size_t>(held))) {
        builder.AddMatch(node, match, labels[node]);
      }
    }
    for (const MatchTable::Match& match : problem.matches.At(node, level_index)) builder.AddMatch(node, match, alpha);
  }
  return std::move(builder).Graph();
}

}  // namespace depthfarm::benchmarks
