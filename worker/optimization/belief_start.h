#ifndef DEPTHFARM_WORKER_OPTIMIZATION_BELIEF_START_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_BELIEF_START_H_

#include <cstdint>
#include <stop_token>
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

inline constexpr int kBeliefPasses = 2;  // of the default; a third gains nothing

// A start much nearer to the optimum of E than each node's best reward, at the price of a few moves: belief
// propagation over the grids of all views. Each of `iterations` passes sums, for each free node, the least costs along
// its row and column from all four sides (as semi-global matching does, Hirschmueller, PAMI 2008), with V as in eq. (2)
// and each node's rewards as its own cost. From the second pass on a reward counts only as far as the segment that it
// needs agrees: less what that one's belief of the level is worse than its best. Then each free node takes the level
// that it believes in most, the farthest of equals; fixed nodes keep what `labels` holds and are certain of it.
//
// Costs are 16-bit integers, so the result is the same everywhere; a cost along a path never exceeds kMostPathCost of
// them, and rewards larger than fit are scaled down. Passes read the pass before: the order of views does not matter.
// Work: free nodes x levels x passes. Returns early, with labels as they were, when cancelled.
void BeliefStart(const LabellingProblem& problem, const std::vector<SegmentGrid>& grids, int iterations,
                 std::vector<Level>& labels, const std::stop_token& stop);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_BELIEF_START_H_
