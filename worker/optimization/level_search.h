#ifndef DEPTHFARM_WORKER_OPTIMIZATION_LEVEL_SEARCH_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_LEVEL_SEARCH_H_

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "worker/optimization/belief_start.h"
#include "worker/optimization/labelling_problem.h"

namespace depthfarm {

// In which order a problem's levels are expanded, and who may move to them. Labels hold the start and then the result,
// which is the same on any number of threads.
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
                                        const std::stop_token& stop, int threads = 1);

// A free node finds a level plausible that it believes at most so much worse than its best, match steps; the reward of
// two perfect matches is 540.
inline constexpr std::int32_t kPlausible = 200;

// A fraction of the work, from a good start (worker/optimization/belief_start.h). First each k-th level (k = 4; of 33
// to 63 levels 2 or 3, of at most 32 levels 1), upwards. In each fourth of these moves, and in all where there are at
// most 32 levels or nothing is believed, every free node moves; in the others those that believe it plausible, or one
// of the k levels around it. Then SearchNear, three levels. Each move is exact on the nodes that it moves, so the
// energy never rises.
[[nodiscard]] SearchSummary SearchSparsely(const LabellingProblem& problem, LevelBeliefs beliefs,
                                           std::vector<Level>& labels, const std::stop_token& stop, int threads = 1);

// From labels that are nearly right: downwards, every free node may move to levels at most `band` (in indices of the
// problem's levels) from its own or a linked node's; then, upwards, to a linked node's. The energy never rises.
[[nodiscard]] SearchSummary SearchNear(const LabellingProblem& problem, std::size_t band, std::vector<Level>& labels,
                                       const std::stop_token& stop, int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_LEVEL_SEARCH_H_
