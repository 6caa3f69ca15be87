#ifndef DEPTHFARM_TESTS_BENCHMARKS_MOVE_GRAPH_H_
#define DEPTHFARM_TESTS_BENCHMARKS_MOVE_GRAPH_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "worker/optimization/labelling_problem.h"

namespace depthfarm::benchmarks {

// The minimum cut problem of one expansion move, as data that any solver can be given.
struct MoveGraph {
  struct Edge {
    std::uint32_t u = 0;
    std::uint32_t v = 0;
    std::int32_t capacity = 0;  // > 0, in both directions
  };
  std::vector<std::int64_t> terminal;  // per node: > 0 capacity from the source, < 0 to the sink
  std::vector<Edge> edges;             // two nodes may share several
  std::int64_t constant = 0;           // change of energy of the best move = constant + maximum flow

  [[nodiscard]] std::size_t num_nodes() const { return terminal.size(); }
};

// The move of problem.levels[level_index] from `labels` (docs/method.md, 4), from the four values of each term. Every
// node of the problem is a node of the graph; those that cannot change have no edges.
[[nodiscard]] MoveGraph GraphOfMove(const LabellingProblem& problem, const std::vector<Level>& labels,
                                    std::size_t level_index);

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_MOVE_GRAPH_H_
