#ifndef DEPTHFARM_TESTS_EXPERIMENTS_ANCHORED_PROBLEM_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_ANCHORED_PROBLEM_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "worker/optimization/labelling_problem.h"
#include "worker/optimization/level_search.h"

namespace depthfarm {

// A labelling problem whose data terms are each node's own. The core rewards agreements of two nodes; here one fixed
// node per level, an anchor, holds that level for ever, and who takes a level agrees with its anchor.
class AnchoredProblem {
 public:
  AnchoredProblem(NodeIndex nodes, int num_levels) : nodes_(nodes) {
    problem_.num_nodes = nodes + static_cast<NodeIndex>(num_levels);
    problem_.matches_per_node = 1;
    rewards_.resize(static_cast<std::size_t>(num_levels) * nodes);
    problem_.fixed.assign(problem_.num_nodes, 0);
    for (int level = 0; level < num_levels; ++level) {
      problem_.levels.push_back(static_cast<Level>(level));
      problem_.fixed[nodes + static_cast<NodeIndex>(level)] = 1;
    }
  }

  // A node that holds `level` is rewarded by so many match steps.
  void SetReward(int level, NodeIndex node, std::uint16_t steps) {
    rewards_[static_cast<std::size_t>(level) * nodes_ + node] = steps;
  }
  [[nodiscard]] std::vector<SmoothnessLink>& smoothness() { return problem_.smoothness; }

  // Labels of the nodes after `sweeps` sweeps of alpha-expansion from each node's best level.
  [[nodiscard]] std::vector<Level> Solve(int sweeps) {
    problem_.matches = Matches();
    std::vector<Level> labels(problem_.num_nodes);
    for (std::size_t level = 0; level < problem_.levels.size(); ++level) {
      labels[nodes_ + level] = static_cast<Level>(level);
    }
    WinnerTakesAll(problem_, labels);
    (void)SearchFully(problem_, labels, sweeps, {});
    labels.resize(nodes_);
    return labels;
  }

 private:
  [[nodiscard]] MatchTable Matches() const {
    MatchTableBuilder matches(1);
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
      for (std::size_t level = 0; level < problem_.levels.size() && node < nodes_; ++level) {
        matches.Add(level, nodes_ + static_cast<NodeIndex>(level), rewards_[level * nodes_ + node]);
      }
      matches.EndNode();
    }
    return std::move(matches).Take();
  }

  NodeIndex nodes_;
  std::vector<std::uint16_t> rewards_;  // [level][node], match steps
  LabellingProblem problem_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_ANCHORED_PROBLEM_H_
