#ifndef DEPTHFARM_WORKER_MERGING_FUSION_H_
#define DEPTHFARM_WORKER_MERGING_FUSION_H_

#include <cstdint>
#include <vector>

#include "worker/optimization/labelling_problem.h"

namespace depthfarm {

// Two labellings of the same nodes, and the matches of each node on the level it holds in either.
struct FusionProblem {
  NodeIndex num_nodes = 0;
  int matches_per_node = 0;  // D
  const std::vector<SmoothnessLink>* smoothness = nullptr;
  std::vector<Level> labels[2];       // per node; [0] the first map, [1] the second
  std::vector<MatchLink> matches[2];  // [node][slot]: on the node's level in that map; equal where the levels are
};

struct FusionResult {
  std::vector<Level> labels;
  std::vector<std::uint8_t> from_second;  // per node
  std::int64_t energy = 0;                // E of eq. (1) of the result, from scratch
  std::int64_t first_energy = 0;          // of the two maps that went in
  std::int64_t second_energy = 0;
};

// Merges two depth maps (paper IV-A, Fig. 3): each node takes its level of the first (x = 0) or of the second map (x =
// 1), a minimum cut of eq. (1) over these two choices. Ties keep the first map (canonical cut).
//
// Exact when the maps come from contiguous blocks merged in order: then all levels of the first lie below all of the
// second, and with |A_s - A_t| = 2 max(A) - A_s - A_t, |B_s - B_t| = B_s + B_t - 2 min(B),
//   V(A_s, A_t) + V(B_s, B_t) = beta ((B_s + B_t) - (A_s + A_t) - 2 (min(B) - max(A))) <= V(A_s, B_t) + V(B_s, A_t),
// so V is submodular; any V convex in the label difference has the property. It fails for a truncated V (both mixed
// terms may stop at the bound while the pure ones do not) and once the ranges overlap: interleaved levels, or
// contiguous blocks merged out of order (0 with 2, then with 1). There the guard raises the mixed terms by the excess,
// half each. Pure labellings keep their energy and mixed ones are never undervalued, so E(result) <= min(E(first),
// E(second)) always. M terms are submodular as in expansions, except a reward that would need one node from each map:
// that reward is left out of the cut (again only raising a mixed term).
[[nodiscard]] FusionResult Fuse(const FusionProblem& problem);

// E of eq. (1) when node s takes problem.labels[choice[s]][s].
[[nodiscard]] std::int64_t FusionEnergy(const FusionProblem& problem, const std::vector<std::uint8_t>& choice);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MERGING_FUSION_H_
