#ifndef DEPTHFARM_WORKER_OPTIMIZATION_LABELLING_PROBLEM_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_LABELLING_PROBLEM_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/depth_levels.h"
#include "worker/cost/energy_units.h"

namespace depthfarm {

// A segment of any view of a frame: the segments of all views in one numbering.
using NodeIndex = std::uint32_t;

// V of eq. (2) between two adjacent segments: beta * |d_first - d_second| energy units. beta is even.
struct SmoothnessLink {
  NodeIndex first = 0;
  NodeIndex second = 0;
  std::int32_t beta = 0;
};

// M of eq. (5) in one direction: a segment that holds some level is rewarded by `reward` match steps if `target` holds
// the same level. reward 0: no match there. The relation is not symmetric: the target's own match is another term.
struct MatchLink {
  NodeIndex target = 0;
  std::uint16_t reward = 0;

  [[nodiscard]] std::int32_t RewardUnits() const { return reward * kEnergyUnitsPerMatchStep; }
};

// E of eq. (1) with numbers filled in, for a subset of the levels: what alpha-expansion minimises.
struct LabellingProblem {
  NodeIndex num_nodes = 0;
  std::vector<Level> levels;               // the levels that free nodes may take, ascending
  int matches_per_node = 0;                // D: neighbour views at most
  std::vector<MatchLink> matches;          // [level index][node][slot], size levels x nodes x D
  std::vector<SmoothnessLink> smoothness;  // each adjacent pair once
  std::vector<std::uint8_t> fixed;         // per node: 1 = unchanged (III-E): keeps its label, which may be any level

  [[nodiscard]] const MatchLink* Matches(std::size_t level_index, NodeIndex node) const {
    return matches.data() + (level_index * num_nodes + node) * static_cast<std::size_t>(matches_per_node);
  }
};

// Index of `level` in problem.levels, or -1.
[[nodiscard]] int LevelIndex(const LabellingProblem& problem, Level level);

// E of eq. (1) from scratch: sum of V over all links and of -reward over all matches whose ends agree. Matches of fixed
// nodes on levels outside problem.levels are not counted (no move can change them). Energy units.
[[nodiscard]] std::int64_t TotalEnergy(const LabellingProblem& problem, const std::vector<Level>& labels);

// The start of the optimisation: each free node takes the level with the largest sum of rewards, the farthest of
// equals. Fixed nodes keep what `labels` holds.
void WinnerTakesAll(const LabellingProblem& problem, std::vector<Level>& labels);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_LABELLING_PROBLEM_H_
