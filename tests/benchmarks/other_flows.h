#ifndef DEPTHFARM_TESTS_BENCHMARKS_OTHER_FLOWS_H_
#define DEPTHFARM_TESTS_BENCHMARKS_OTHER_FLOWS_H_

#include <cstdint>

#include "tests/benchmarks/move_graph.h"

namespace depthfarm::benchmarks {

// A graph solved once: its maximum flow, and the CPU seconds of putting it together and of solving it.
struct SolvedFlow {
  std::int64_t flow = 0;
  double build_seconds = 0;
  double solve_seconds = 0;
};

// Boost.Graph on a compressed_sparse_row_graph with its properties in flat arrays: on adjacency_list, whose edges are
// allocated one by one, both take longer.
[[nodiscard]] SolvedFlow SolveWithBoostBoykovKolmogorov(const MoveGraph& graph);
[[nodiscard]] SolvedFlow SolveWithBoostPushRelabel(const MoveGraph& graph);

// OpenCV's GCGraph, a Boykov-Kolmogorov. Its cuts, hence its flows, are not always minimum ones.
[[nodiscard]] SolvedFlow SolveWithOpenCv(const MoveGraph& graph);

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_OTHER_FLOWS_H_
