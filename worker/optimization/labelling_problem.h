#ifndef DEPTHFARM_WORKER_OPTIMIZATION_LABELLING_PROBLEM_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_LABELLING_PROBLEM_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/depth_levels.h"
#include "worker/optimization/match_table.h"

namespace depthfarm {

// V of eq. (2) between two adjacent segments: beta * |d_first - d_second| energy units. beta is even.
struct SmoothnessLink {
  NodeIndex first = 0;
  NodeIndex second = 0;
  std::int32_t beta = 0;
};

// E of eq. (1) with numbers filled in, for a subset of the levels: what alpha-expansion minimises.
struct LabellingProblem {
  NodeIndex num_nodes = 0;
  std::vector<Level> levels;               // the levels that free nodes may take, ascending
  int matches_per_node = 0;                // D: neighbour views at most, so matches of a node on one level
  MatchTable matches;                      // of every node, on the levels by their index
  std::vector<SmoothnessLink> smoothness;  // each adjacent pair once
  std::vector<std::uint8_t> fixed;         // per node: 1 = unchanged (III-E): keeps its label, which may be any level
  std::vector<NodeIndex> view_begin;       // the first node of each view, ascending from 0; empty: all are of one
};

// Cuts the nodes into `parts`, >= 1: of each view the first, second ... piece of its nodes, so that the part is a band
// of all views. Segments are numbered row by row, so most links of a node stay in its part. Returns the part of each
// node. Says nothing of the result: for threads that work side by side.
[[nodiscard]] std::vector<std::uint16_t> BandsOf(const LabellingProblem& problem, int parts);

// Index of `level` in problem.levels, or -1.
[[nodiscard]] int LevelIndex(const LabellingProblem& problem, Level level);

// E of eq. (1) from scratch: sum of V over all links and of -reward over all matches whose ends agree. Matches of fixed
// nodes on levels outside problem.levels are not counted (no move can change them). Energy units.
[[nodiscard]] std::int64_t TotalEnergy(const LabellingProblem& problem, const std::vector<Level>& labels,
                                       int threads = 1);

// The start of the optimisation: each free node takes the level with the largest sum of rewards, the farthest of
// equals. Fixed nodes keep what `labels` holds.
void WinnerTakesAll(const LabellingProblem& problem, std::vector<Level>& labels);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_LABELLING_PROBLEM_H_
