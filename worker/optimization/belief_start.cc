#include "worker/optimization/belief_start.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <utility>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

using Cost = std::int16_t;

constexpr int kMostReward = 1000;           // of all matches of a node on a level together
constexpr int kMostPathCost = 4000;         // four of them and three rewards fit
constexpr std::size_t kLinesAtOnce = 8;     // rows or columns, of a thread
constexpr std::size_t kNodesAtOnce = 1024;  // the same where each node is by itself

class Beliefs {
 public:
  Beliefs(const LabellingProblem& problem, const std::vector<Level>& labels, int threads)
      : problem_(problem), labels_(labels), threads_(threads), levels_(problem.levels.size()), row_(problem.num_nodes) {
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
    for (std::size_t level = 1; level < levels_; ++level) {
      gaps_.push_back(problem.levels[level] - problem.levels[level - 1]);
    }
  }

  // One pass; `first`: nothing is believed yet.
  void Pass(const std::vector<SegmentGrid>& grids, bool first) {
    ForPieces(problem_.num_nodes, [&](std::size_t begin, std::size_t end) { TakeRewards(begin, end, first); });
    ForPieces(num_free_, [&](std::size_t begin, std::size_t end) {
      std::fill(&paths_[begin * levels_], &paths_[begin * levels_] + (end - begin) * levels_, Cost{0});
    });
    FollowLines(grids, &SegmentGrid::rows, [](const SegmentGrid& grid, int row) {
      return Line{row * grid.columns, 1, grid.columns, grid.beta_right};
    });
    FollowLines(grids, &SegmentGrid::columns, [](const SegmentGrid& grid, int column) {
      return Line{column, grid.columns, grid.rows, grid.beta_down};
    });
    ForPieces(num_free_, [&](std::size_t begin, std::size_t end) { Believe(begin, end); });
  }

  // The levels that nodes believe in most; of free nodes alone.
  void TakeBest(std::vector<Level>& labels) const {
    ForPieces(problem_.num_nodes, [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = begin; node < end; ++node) {
        if (!IsFree(static_cast<NodeIndex>(node))) continue;
        const Cost* belief = &paths_[row_[node] * levels_];
        labels[node] = problem_.levels[static_cast<std::size_t>(std::min_element(belief, belief + levels_) - belief)];
      }
    });
  }

  [[nodiscard]] LevelBeliefs Take() && { return {std::move(row_), std::move(paths_), levels_, shift_}; }

 private:
  [[nodiscard]] bool IsFree(NodeIndex node) const { return problem_.fixed[node] == 0; }
  [[nodiscard]] Cost Scaled(std::int32_t match_steps) const { return static_cast<Cost>(match_steps >> shift_); }

  template <typename Each>
  void ForPieces(std::size_t count, const Each& each) const {
    ParallelForPieces(count, kNodesAtOnce, threads_, each);
  }

  // own_: minus what each level earns. Of the nodes [begin, end).
  void TakeRewards(std::size_t begin, std::size_t end, bool first) {
    for (auto node = static_cast<NodeIndex>(begin); node < end; ++node) {
      if (!IsFree(node)) continue;
      Cost* own = &own_[row_[node] * levels_];
      std::fill(own, own + levels_, Cost{0});
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
    const std::vector<std::int32_t>& beta;  // of each node to the next
  };
  // Along all lines of the grids, forth and back. `count`: the member of a grid that says how many; line_of: one of
  // them.
  template <typename LineOf>
  void FollowLines(const std::vector<SegmentGrid>& grids, int SegmentGrid::*count, const LineOf& line_of) {
    for (const SegmentGrid& grid : grids) {
      ParallelForPieces(static_cast<std::size_t>(grid.*count), kLinesAtOnce, threads_,
                        [&](std::size_t begin, std::size_t end) {
                          Path path(*this);
                          for (std::size_t i = begin; i < end; ++i)
                            path.AlongBothWays(grid, line_of(grid, static_cast<int>(i)));
                        });
    }
  }

  // A path that is followed, level by level.
  class Path {
   public:
    explicit Path(Beliefs& beliefs) : all_(beliefs), path_(beliefs.levels_), rise_(beliefs.levels_) {}

    void AlongBothWays(const SegmentGrid& grid, const Line& line) {
      NodeIndex before = 0;
      for (const bool back : {false, true}) {
        const NodeIndex* from = nullptr;
        for (int i = 0; i < line.count; ++i) {
          const int at = line.begin + line.step * (back ? line.count - 1 - i : i);
          const int link = back ? at : at - line.step;  // the one that leads here
          const NodeIndex node = grid.first + static_cast<NodeIndex>(at);
          Follow(from, node, from == nullptr ? 0 : line.beta[static_cast<std::size_t>(link)]);
          before = node;
          from = &before;
        }
      }
    }

   private:
    // Takes the path from the node before (null: there is none) to `node`.
    void Follow(const NodeIndex* before, NodeIndex node, std::int32_t beta) {
      if (!all_.IsFree(node)) return;  // certain: what comes after it does not ask what was before it
      const std::size_t levels = all_.levels_;
      const Cost* own = &all_.own_[all_.row_[node] * levels];
      if (before == nullptr) {
        std::copy(own, own + levels, path_.begin());
      } else {
        const int shift = all_.shift_;
        const int scaled = (std::max(1, beta / kEnergyUnitsPerMatchStep) >> shift) + (shift > 0 ? 1 : 0);
        const int step = std::min(scaled, kMostPathCost);
        if (all_.IsFree(*before)) {
          Spread(step);
        } else {
          SpreadFrom(all_.labels_[*before], step);
        }
        for (std::size_t level = 0; level < levels; ++level) {
          path_[level] = static_cast<Cost>(path_[level] + own[level]);
        }
      }
      Cost* sum = &all_.paths_[all_.row_[node] * levels];
      for (std::size_t level = 0; level < levels; ++level) sum[level] = static_cast<Cost>(sum[level] + path_[level]);
    }

    // path_[l] = min over l' of path_[l'] + step |l - l'|, less the least of all, at most kMostPathCost.
    void Spread(int step_between_levels) {
      const std::size_t levels = all_.levels_;
      const Cost least = *std::min_element(path_.begin(), path_.end());
      for (Cost& cost : path_) cost = static_cast<Cost>(std::min(cost - least, kMostPathCost));
      for (std::size_t level = 0; level + 1 < levels; ++level) {
        rise_[level] = static_cast<Cost>(std::min(step_between_levels * all_.gaps_[level], kMostPathCost));
      }
      Cost reached = path_[0];
      for (std::size_t level = 1; level < levels; ++level) {
        reached = std::min(path_[level], static_cast<Cost>(reached + rise_[level - 1]));
        path_[level] = reached;
      }
      for (std::size_t level = levels - 1; level-- > 0;) {
        reached = std::min(path_[level], static_cast<Cost>(reached + rise_[level]));
        path_[level] = reached;
      }
    }

    // The same of a node that is certain.
    void SpreadFrom(Level held, int step) {
      for (std::size_t level = 0; level < all_.levels_; ++level) {
        const std::int64_t distance = std::abs(int{all_.problem_.levels[level]} - int{held});
        path_[level] = static_cast<Cost>(std::min<std::int64_t>(distance * step, kMostPathCost));
      }
    }

    Beliefs& all_;
    std::vector<Cost> path_;  // per level
    std::vector<Cost> rise_;  // from each level to the next, of the link that is followed
  };

  // paths_: from sums of four paths, each with the node's own cost, to how much worse each level is than the best.
  void Believe(std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
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
  int threads_;
  std::size_t levels_;
  std::vector<std::uint32_t> row_;  // of free nodes: their place among them
  std::uint32_t num_free_ = 0;
  int shift_ = 0;            // match steps to costs
  std::vector<Cost> own_;    // [free node][level]
  std::vector<Cost> paths_;  // [free node][level]: in a pass sums of paths, then beliefs
  std::vector<int> gaps_;    // from each level to the next
};

}  // namespace

LevelBeliefs BeliefStart(const LabellingProblem& problem, const std::vector<SegmentGrid>& grids, int iterations,
                         std::vector<Level>& labels, const std::stop_token& stop, int threads) {
  Beliefs beliefs(problem, labels, threads);
  for (int pass = 0; pass < iterations; ++pass) {
    if (stop.stop_requested()) return {};
    beliefs.Pass(grids, pass == 0);
  }
  beliefs.TakeBest(labels);
  return std::move(beliefs).Take();
}

}  // namespace depthfarm
