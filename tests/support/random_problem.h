#ifndef DEPTHFARM_TESTS_SUPPORT_RANDOM_PROBLEM_H_
#define DEPTHFARM_TESTS_SUPPORT_RANDOM_PROBLEM_H_

#include <vector>

#include "tests/support/match_lists.h"
#include "tests/support/random.h"
#include "worker/optimization/labelling_problem.h"

namespace depthfarm::test {

// Two or three "views" of random segments with links of all kinds: V within a view, M between views, parallel and
// reciprocal matches, fixed nodes with levels inside and outside the problem's.
struct RandomProblem {
  LabellingProblem problem;
  std::vector<Level> labels;
};

inline RandomProblem MakeRandomProblem(Random& random, int nodes_per_view, int num_views, int num_levels,
                                       int fixed_percent) {
  RandomProblem result;
  LabellingProblem& problem = result.problem;
  problem.num_nodes = static_cast<NodeIndex>(nodes_per_view * num_views);
  for (int level = 0; level < num_levels; ++level) problem.levels.push_back(static_cast<Level>(2 * level + 1));
  problem.matches_per_node = 2;
  std::vector<MatchLink> matches(problem.levels.size() * problem.num_nodes * 2);
  const auto node_of = [&](int view, int segment) { return static_cast<NodeIndex>(view * nodes_per_view + segment); };
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const int view = static_cast<int>((i / 2) % problem.num_nodes) / nodes_per_view;
    if (random.Chance(40)) continue;
    const int other = (view + random.Int(1, num_views - 1)) % num_views;
    matches[i] = {node_of(other, random.Int(0, nodes_per_view - 1)), static_cast<std::uint16_t>(random.Int(0, 270))};
  }
  problem.matches = TableOf(matches, problem.levels.size(), problem.num_nodes, 2);
  for (int view = 0; view < num_views; ++view) {
    for (int s = 0; s < nodes_per_view; ++s) {
      for (int t = s + 1; t < nodes_per_view; ++t) {
        if (random.Int(0, nodes_per_view) > 4) continue;
        problem.smoothness.push_back({node_of(view, s), node_of(view, t), 2 * random.Int(1, 4000)});
      }
    }
  }
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    const bool fixed = random.Chance(fixed_percent);
    problem.fixed.push_back(fixed ? 1 : 0);
    result.labels.push_back(fixed ? static_cast<Level>(random.Int(0, 2 * num_levels))
                                  : problem.levels[static_cast<std::size_t>(random.Int(0, num_levels - 1))]);
  }
  return result;
}

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_SUPPORT_RANDOM_PROBLEM_H_
