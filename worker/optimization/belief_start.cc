#include "worker/optimization/belief_start.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <utility>

namespace depthfarm {
namespace {

using Cost = std::int16_t;

constexpr int kMostReward = 1000;    // of all matches of a node on a level together
constexpr int kMostPathCost = 4000;  // four of them and three rewards fit

class Beliefs {
 public:
  Beliefs(const LabellingProblem& problem, const std::vector<Level>& labels)
      : problem_(problem), labels_(labels), levels_(problem.levels.size()), row_(problem.num_nodes) {
    int most = 0;
    for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
      row_[node] = num_free_;
      if (problem.fixed[node] != 0) continue;
      ++num_free_;
      for (const MatchTable::Match& match : problem.matches.Of(node)) most = std::max<int>(most, match.reward);
    }
    while ((problem.matches_per_node * most) >> shift_ > kMostReward) ++shift_;
    own_.resize(num_free_ * levels_);
    paths_.resize(num_free_ * levels_);
    path_.resize(levels_);
    rise_.resize(levels_);
    for (std::size_t level = 1; level < levels_; ++level) {
      gaps_.push_back(problem.levels[level] - problem.levels[level - 1]);
    }
  }

  // One pass; `first`: nothing is believed yet.
  void Pass(const std::vector<SegmentGrid>& grids, bool first) {
    TakeRewards(first);
    std::fill(paths_.begin(), paths_.end(), Cost{0});
    for (const SegmentGrid& grid : grids) {
      for (int row = 0; row < grid.rows; ++row)
        AlongBothWays(grid, grid.beta_right, {row * grid.columns, 1, grid.columns});
      for (int column = 0; column < grid.columns; ++column)
        AlongBothWays(grid, grid.beta_down, {column, grid.columns, grid.rows});
    }
    Believe();
  }

  [[nodiscard]] Level Best(NodeIndex node) const {
    const Cost* belief = &paths_[row_[node] * levels_];
    return problem_.levels[static_cast<std::size_t>(std::min_element(belief, belief + levels_) - belief)];
  }

  [[nodiscard]] LevelBeliefs Take() && { return {std::move(row_), std::move(paths_), levels_, shift_}; }

 private:
  [[nodiscard]] bool IsFree(NodeIndex node) const { return problem_.fixed[node] == 0; }
  [[nodiscard]] Cost Scaled(std::int32_t match_steps) const { return static_cast<Cost>(match_steps >> shift_); }

  // own_: minus what each level earns.
  void TakeRewards(bool first) {
    std::fill(own_.begin(), own_.end(), Cost{0});
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
      if (!IsFree(node)) continue;
      Cost* own = &own_[row_[node] * levels_];
      for (const MatchTable::Match& match : problem_.matches.Of(node)) {
        int reward = Scaled(match.reward);
        if (!IsFree(match.target)) {
          if (labels_[match.target] != problem_.levels[match.level]) continue;
        } else if (!first) {
          reward = std::max(0, reward - paths_[row_[match.target] * levels_ + match.level]);
        }
        own[match.level] = static_cast<Cost>(own[match.level] - reward);
      }
    }
  }

  struct Line {  // of the grid's nodes begin, begin + step, ...
    int begin = 0;
    int step = 0;
    int count = 0;
  };
  // Along a line, forth and back. beta: of each node to the next.
  void AlongBothWays(const SegmentGrid& grid, const std::vector<std::int32_t>& beta, const Line& line) {
    NodeIndex before = 0;
    for (const bool back : {false, true}) {
      const NodeIndex* from = nullptr;
      for (int i = 0; i < line.count; ++i) {
        const int at = line.begin + line.step * (back ? line.count - 1 - i : i);
        const int link = back ? at : at - line.step;  // the one that leads here
        const NodeIndex node = grid.first + static_cast<NodeIndex>(at);
        Follow(from, node, from == nullptr ? 0 : beta[static_cast<std::size_t>(link)]);
        before = node;
        from = &before;
      }
    }
  }

  // Takes the path from the node before (null: there is none) to `node`.
  void Follow(const NodeIndex* before, NodeIndex node, std::int32_t beta) {
    if (!IsFree(node)) return;  // certain: what comes after it does not ask what was before it
    const Cost* own = &own_[row_[node] * levels_];
    if (before == nullptr) {
      std::copy(own, own + levels_, path_.begin());
    } else {
      const int scaled = (std::max(1, beta / kEnergyUnitsPerMatchStep) >> shift_) + (shift_ > 0 ? 1 : 0);
      const int step = std::min(scaled, kMostPathCost);
      if (IsFree(*before)) {
        Spread(step);
      } else {
        SpreadFrom(labels_[*before], step);
      }
      for (std::size_t level = 0; level < levels_; ++level) {
        path_[level] = static_cast<Cost>(path_[level] + own[level]);
      }
    }
    Cost* sum = &paths_[row_[node] * levels_];
    for (std::size_t level = 0; level < levels_; ++level) sum[level] = static_cast<Cost>(sum[level] + path_[level]);
  }

  // path_[l] = min over l' of path_[l'] + step |l - l'|, less the least of all, at most kMostPathCost.
  void Spread(int step_between_levels) {
    const Cost least = *std::min_element(path_.begin(), path_.end());
    for (Cost& cost : path_) cost = static_cast<Cost>(std::min(cost - least, kMostPathCost));
    for (std::size_t level = 0; level + 1 < levels_; ++level) {
      rise_[level] = static_cast<Cost>(std::min(step_between_levels * gaps_[level], kMostPathCost));
    }
    Cost reached = path_[0];
    for (std::size_t level = 1; level < levels_; ++level) {
      reached = std::min(path_[level], static_cast<Cost>(reached + rise_[level - 1]));
      path_[level] = reached;
    }
    for (std::size_t level = levels_ - 1; level-- > 0;) {
      reached = std::min(path_[level], static_cast<Cost>(reached + rise_[level]));
      path_[level] = reached;
    }
  }

  // The same of a node that is certain.
  void SpreadFrom(Level held, int step) {
    for (std::size_t level = 0; level < levels_; ++level) {
      const std::int64_t distance = std::abs(int{problem_.levels[level]} - int{held});
      path_[level] = static_cast<Cost>(std::min<std::int64_t>(distance * step, kMostPathCost));
    }
  }

  // paths_: from sums of four paths, each with the node's own cost, to how much worse each level is than the best.
  void Believe() {
    for (std::size_t row = 0; row < num_free_; ++row) {
      Cost* belief = &paths_[row * levels_];
      const Cost* own = &own_[row * levels_];
      Cost least = std::numeric_limits<Cost>::max();
      for (std::size_t level = 0; level < levels_; ++level) {
        belief[level] = static_cast<Cost>(belief[level] - 3 * own[level]);
        least = std::min(least, belief[level]);
      }
      for (std::size_t level = 0; level < levels_; ++level) belief[level] = static_cast<Cost>(belief[level] - least);
    }
  }

  const LabellingProblem& problem_;
  const std::vector<Level>& labels_;
  std::size_t levels_;
  std::vector<std::uint32_t> row_;  // of free nodes: their place among them
  std::uint32_t num_free_ = 0;
  int shift_ = 0;            // match steps to costs
  std::vector<Cost> own_;    // [free node][level]
  std::vector<Cost> paths_;  // [free node][level]: in a pass sums of paths, then beliefs
  std::vector<int> gaps_;    // from each level to the next
  std::vector<Cost> rise_;   // from each level to the next, of the link that is followed
  std::vector<Cost> path_;   // per level: the path that is followed
};

}  // namespace

LevelBeliefs BeliefStart(const LabellingProblem& problem, const std::vector<SegmentGrid>& grids, int iterations,
                         std::vector<Level>& labels, const std::stop_token& stop) {
  Beliefs beliefs(problem, labels);
  for (int pass = 0; pass < iterations; ++pass) {
    if (stop.stop_requested()) return {};
    beliefs.Pass(grids, pass == 0);
  }
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    if (problem.fixed[node] == 0) labels[node] = beliefs.Best(node);
  }
  return std::move(beliefs).Take();
}

}  // namespace depthfarm
