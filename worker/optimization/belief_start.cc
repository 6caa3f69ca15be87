#include "worker/optimization/belief_start.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "common/base/parallel.h"
#include "worker/optimization/path_kernels.h"

namespace depthfarm {
namespace {

using Cost = std::int16_t;

constexpr int kMostReward = 1000;           // of all matches of a node on a level together
constexpr std::size_t kLinesAtOnce = 8;     // rows or columns, of a thread
constexpr std::size_t kNodesAtOnce = 1024;  // the same where each node is by itself

class Beliefs {
 public:
  Beliefs(const LabellingProblem& problem, const std::vector<Level>& labels, int threads)
      : problem_(problem),
        labels_(labels),
        threads_(threads),
        levels_(problem.levels.size()),
        stride_((levels_ + kPathBlock - 1) / kPathBlock * kPathBlock),
        row_(problem.num_nodes) {
    for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
      row_[node] = num_free_;
      num_free_ += IsFree(node) ? 1 : 0;
    }
    const int most = problem.matches_per_node * MostReward();
    while (most >> shift_ > kMostReward) ++shift_;
    own_ = std::make_unique_for_overwrite<Cost[]>(num_free_ * stride_);
    paths_ = std::make_unique_for_overwrite<Cost[]>(num_free_ * stride_);
    if (levels_ > 1) gap_ = (problem.levels.back() - problem.levels.front()) / static_cast<int>(levels_ - 1);
  }

  // One pass; `first`: nothing is believed yet.
  void Pass(const std::vector<SegmentGrid>& grids, bool first) {
    ForPieces(problem_.num_nodes, [&](std::size_t begin, std::size_t end) { TakeRewards(begin, end, first); });
    ForPieces(num_free_, [&](std::size_t begin, std::size_t end) {
      std::fill(&paths_[begin * stride_], &paths_[begin * stride_] + (end - begin) * stride_, Cost{0});
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
        const Cost* belief = &paths_[row_[node] * stride_];
        labels[node] = problem_.levels[static_cast<std::size_t>(std::min_element(belief, belief + levels_) - belief)];
      }
    });
  }

  [[nodiscard]] LevelBeliefs Take() && { return {std::move(row_), std::move(paths_), levels_, stride_, shift_}; }

 private:
  [[nodiscard]] bool IsFree(NodeIndex node) const { return problem_.fixed[node] == 0; }
  [[nodiscard]] Cost Scaled(std::int32_t match_steps) const { return static_cast<Cost>(match_steps >> shift_); }

  template <typename Each>
  void ForPieces(std::size_t count, const Each& each) const {
    ParallelForPieces(count, kNodesAtOnce, threads_, each);
  }

  // Of the matches of free nodes.
  [[nodiscard]] int MostReward() const {
    std::mutex mutex;
    int most = 0;
    ForPieces(problem_.num_nodes, [&](std::size_t begin, std::size_t end) {
      int of_piece = 0;
      const auto look = [&](NodeIndex node, const MatchTable::Match& match) {
        if (IsFree(node)) of_piece = std::max<int>(of_piece, match.reward);
      };
      problem_.matches.ForEachOf(static_cast<NodeIndex>(begin), static_cast<NodeIndex>(end), look);
      const std::scoped_lock lock(mutex);
      most = std::max(most, of_piece);
    });
    return most;
  }

  // own_: minus what each level earns. Of the nodes [begin, end).
  void TakeRewards(std::size_t begin, std::size_t end, bool first) {
    for (auto node = static_cast<NodeIndex>(begin); node < end; ++node) {
      if (!IsFree(node)) continue;
      Cost* own = &own_[row_[node] * stride_];
      std::fill(own, own + stride_, Cost{0});
    }
    const auto take = [&](NodeIndex node, const MatchTable::Match& match) {
      if (!IsFree(node)) return;
      int reward = Scaled(match.reward);
      if (!IsFree(match.target)) {
        if (labels_[match.target] != problem_.levels[match.level]) return;
      } else if (!first) {
        reward = std::max(0, reward - paths_[row_[match.target] * stride_ + match.level]);
      }
      Cost& own = own_[row_[node] * stride_ + match.level];
      own = static_cast<Cost>(own - reward);
    };
    problem_.matches.ForEachOf(static_cast<NodeIndex>(begin), static_cast<NodeIndex>(end), take);
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
    explicit Path(Beliefs& beliefs) : all_(beliefs), path_(2 * beliefs.stride_) {}

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
      const std::size_t stride = all_.stride_;
      const Cost* own = &all_.own_[all_.row_[node] * stride];
      Cost* sum = &all_.paths_[all_.row_[node] * stride];
      if (before == nullptr) {
        std::copy(own, own + stride, path_.begin());
      } else {
        const int shift = all_.shift_;
        const int scaled = (std::max(1, beta / kEnergyUnitsPerMatchStep) >> shift) + (shift > 0 ? 1 : 0);
        const int step = std::min(scaled, kMostPathCost);
        if (all_.IsFree(*before)) {
          FollowPath(path_, std::min(step * all_.gap_, kMostPathCost), {own, stride}, {sum, stride});
          return;
        }
        SpreadFrom(all_.labels_[*before], step);
        for (std::size_t level = 0; level < stride; ++level) {
          path_[level] = static_cast<Cost>(path_[level] + own[level]);
        }
      }
      for (std::size_t level = 0; level < stride; ++level) sum[level] = static_cast<Cost>(sum[level] + path_[level]);
    }

    // What leads on from a node that is certain.
    void SpreadFrom(Level held, int step) {
      for (std::size_t level = 0; level < all_.levels_; ++level) {
        const std::int64_t distance = std::abs(int{all_.problem_.levels[level]} - int{held});
        path_[level] = static_cast<Cost>(std::min<std::int64_t>(distance * step, kMostPathCost));
      }
      for (std::size_t level = all_.levels_; level < all_.stride_; ++level) path_[level] = kMostPathCost;
    }

    Beliefs& all_;
    std::vector<Cost> path_;  // per level, and as much room for FollowPath
  };

  // paths_: from sums of four paths, each with the node's own cost, to how much worse each level is than the best.
  void Believe(std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      Cost* belief = &paths_[row * stride_];
      const Cost* own = &own_[row * stride_];
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
  std::size_t stride_;              // of rows of costs: levels_, and up to a whole number of blocks
  std::vector<std::uint32_t> row_;  // of free nodes: their place among them
  std::uint32_t num_free_ = 0;
  int shift_ = 0;  // match steps to costs
  // A pass writes them before it reads them: not cleared here, which one thread would do while the others wait.
  std::unique_ptr<Cost[]> own_;    // [free node][level]
  std::unique_ptr<Cost[]> paths_;  // [free node][level]: in a pass sums of paths, then beliefs
  int gap_ = 0;                    // from each level to the next
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
