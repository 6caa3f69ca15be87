#include <cstring>  // gcgraph.hpp does not include what it uses
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

#include "tests/benchmarks/other_flows.h"
#include "tests/benchmarks/thread_seconds.h"

namespace depthfarm::benchmarks {

SolvedFlow SolveWithOpenCv(const MoveGraph& graph) {
  const double start = ThreadSeconds();
  cv::detail::GCGraph<std::int64_t> gc_graph(static_cast<unsigned>(graph.num_nodes()),
                                             static_cast<unsigned>(2 * graph.edges.size()));
  for (const std::int64_t weight : graph.terminal) {
    const int node = gc_graph.addVtx();
    gc_graph.addTermWeights(node, weight > 0 ? weight : 0, weight < 0 ? -weight : 0);
  }
  for (const MoveGraph::Edge& edge : graph.edges) {
    gc_graph.addEdges(static_cast<int>(edge.u), static_cast<int>(edge.v), edge.capacity, edge.capacity);
  }
  const double built = ThreadSeconds();
  const std::int64_t flow = gc_graph.maxFlow();
  return {flow, built - start, ThreadSeconds() - built};
}

}  // namespace depthfarm::benchmarks
