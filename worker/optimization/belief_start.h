#ifndef DEPTHFARM_WORKER_OPTIMIZATION_BELIEF_START_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_BELIEF_START_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "worker/optimization/labelling_problem.h"

namespace depthfarm {

// The segments of a view on the grid that their seeds are on: rows x columns nodes, numbered row by row from `first`.
// What a neighbour on the grid weighs, in energy units per level: beta of eq. (3), though a few of them do not touch.
struct SegmentGrid {
  NodeIndex first = 0;
  int columns = 0;
  int rows = 0;
  std::vector<std::int32_t> beta_right;  // per node, to the next in its row; of the last column not used
  std::vector<std::int32_t> beta_down;   // per node, to the next in its column; of the last row not used
};

// By how much each free node believes each level to be worse than its best.
class LevelBeliefs {
 public:
  // Nothing is believed.
  LevelBeliefs() = default;
  // row: per node, its place among the free ones. costs: of each free node `stride` of them, those of the levels first,
  // in match steps / 2^shift.
  LevelBeliefs(std::vector<std::uint32_t> row, std::unique_ptr<std::int16_t[]> costs, std::size_t levels,
               std::size_t stride, int shift)
      : row_(std::move(row)), costs_(std::move(costs)), levels_(levels), stride_(stride), shift_(shift) {}

  [[nodiscard]] bool empty() const { return costs_ == nullptr; }
  // Of a free node, per level of the problem.
  [[nodiscard]] std::span<const std::int16_t> Of(NodeIndex node) const {
    return {costs_.get() + row_[node] * stride_, levels_};
  }
  // What is compared with them.
  [[nodiscard]] std::int32_t Scaled(std::int32_t match_steps) const { return match_steps >> shift_; }

 private:
  std::vector<std::uint32_t> row_;
  std::unique_ptr<std::int16_t[]> costs_;
  std::size_t levels_ = 0;
  std::size_t stride_ = 0;
  int shift_ = 0;
};

inline constexpr int kBeliefPasses = 2;  // of the default; a third gains nothing

// A start much nearer to the optimum of E than each node's best reward, at the price of a few moves: belief
// propagation over the grids of all views. Each of `iterations` passes sums, for each free node, the least costs along
// its row and column from all four sides (as semi-global matching does, Hirschmueller, PAMI 2008), with V as in eq. (2)
// and each node's rewards as its own cost. From the second pass on a reward counts only as far as the segment that it
// needs agrees: less what that one's belief of the level is worse than its best. Then each free node takes the level
// that it believes in most, the farthest of equals; fixed nodes keep what `labels` holds and are certain of it.
//
// The problem's levels must be an equal way apart, as those of blocks are.
//
// Costs are 16-bit integers, so the result is the same everywhere; a cost along a path never exceeds kMostPathCost of
// them, and rewards larger than fit are scaled down. Passes read the pass before: the order of views does not matter,
// and sums of integers are the same in any order: threads take rows, then columns.
// Work: free nodes x levels x passes. Returns what is believed in the end. Returns early, with nothing and labels as
// they were, when cancelled.
LevelBeliefs BeliefStart(const LabellingProblem& problem, const std::vector<SegmentGrid>& grids, int iterations,
                         std::vector<Level>& labels, const std::stop_token& stop, int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_BELIEF_START_H_
