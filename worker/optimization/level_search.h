#ifndef DEPTHFARM_WORKER_OPTIMIZATION_LEVEL_SEARCH_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_LEVEL_SEARCH_H_

#include <cstdint>
#include <stop_token>
#include <vector>

#include "worker/optimization/labelling_problem.h"

namespace depthfarm {

// In which order a problem's levels are expanded, and who may move to them. Labels hold the start and then the result.
struct SearchSummary {
  int sweeps = 0;
  std::int64_t moves = 0;  // that lowered the energy
  std::int64_t energy = 0;
  bool cancelled = false;
};

// The paper's: every free node may move to every level. Sweeps over all levels, up and down in turn, until no move
// lowers E, or max_sweeps (0 = no limit). A level is not tried again while nothing has changed since its last try (its
// move would find the same problem).
[[nodiscard]] SearchSummary SearchFully(const LabellingProblem& problem, std::vector<Level>& labels, int max_sweeps,
                                        const std::stop_token& stop);

// A fraction of the work, from a good start (worker/optimization/belief_start.h): every free node may move to each k-th
// level (k = 4; of 33 to 63 levels 2 or 3, of at most 32 levels 1); then, downwards, to levels at most three from its own
// or a linked node's; then, upwards, to a linked node's. Each move is exact on the nodes that it moves, so the energy
// never rises.
[[nodiscard]] SearchSummary SearchSparsely(const LabellingProblem& problem, std::vector<Level>& labels,
                                           const std::stop_token& stop);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_LEVEL_SEARCH_H_
