#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>
#include <boost/property_map/property_map.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "tests/benchmarks/other_flows.h"
#include "tests/benchmarks/thread_seconds.h"

namespace depthfarm::benchmarks {
namespace {

using Index = std::uint32_t;
using Graph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                                 boost::no_property, Index, Index>;
using EdgeDescriptor = boost::graph_traits<Graph>::edge_descriptor;

// Source and sink are the last two nodes.
struct BoostProblem {
  Graph graph;
  std::vector<std::int64_t> capacity;   // per arc
  std::vector<EdgeDescriptor> reverse;  // per arc
  std::vector<std::int64_t> residual;   // per arc, of the solution
  Index source = 0;
  Index sink = 0;

  template <typename T>
  [[nodiscard]] auto PerArc(std::vector<T>& values) {
    return boost::make_iterator_property_map(values.begin(), boost::get(boost::edge_index, graph));
  }
  template <typename T>
  [[nodiscard]] auto PerNode(std::vector<T>& values) {
    return boost::make_iterator_property_map(values.begin(), boost::get(boost::vertex_index, graph));
  }
};

// Calls visit(u, v, capacity, capacity back) for every pair of arcs.
template <typename Visit>
void VisitPairs(const MoveGraph& graph, const BoostProblem& problem, const Visit& visit) {
  for (const MoveGraph::Edge& edge : graph.edges) visit(edge.u, edge.v, edge.capacity, edge.capacity);
  for (Index node = 0; node < graph.num_nodes(); ++node) {
    const std::int64_t weight = graph.terminal[node];
    if (weight > 0) visit(problem.source, node, weight, std::int64_t{0});
    if (weight < 0) visit(node, problem.sink, -weight, std::int64_t{0});
  }
}

BoostProblem Build(const MoveGraph& graph) {
  BoostProblem problem;
  problem.source = static_cast<Index>(graph.num_nodes());
  problem.sink = problem.source + 1;
  const Index num_nodes = problem.sink + 1;
  std::vector<Index> place(num_nodes + std::size_t{1}, 0);  // of a node's next arc
  VisitPairs(graph, problem, [&](Index u, Index v, std::int64_t, std::int64_t) {
    ++place[u + 1];
    ++place[v + 1];
  });
  std::partial_sum(place.begin(), place.end(), place.begin());
  const std::size_t num_arcs = place.back();
  std::vector<std::pair<Index, Index>> arcs(num_arcs);
  problem.capacity.resize(num_arcs);
  problem.residual.resize(num_arcs);
  problem.reverse.resize(num_arcs);
  VisitPairs(graph, problem, [&](Index u, Index v, std::int64_t forth, std::int64_t back) {
    const Index a = place[u]++;
    const Index b = place[v]++;
    arcs[a] = {u, v};
    arcs[b] = {v, u};
    problem.capacity[a] = forth;
    problem.capacity[b] = back;
    problem.reverse[a] = EdgeDescriptor(v, b);
    problem.reverse[b] = EdgeDescriptor(u, a);
  });
  problem.graph = Graph(boost::edges_are_sorted, arcs.begin(), arcs.end(), num_nodes, static_cast<Index>(num_arcs));
  return problem;
}

// `algorithm` takes a BoostProblem and returns its maximum flow.
template <typename Algorithm>
SolvedFlow Solve(const MoveGraph& graph, const Algorithm& algorithm) {
  const double start = ThreadSeconds();
  BoostProblem problem = Build(graph);
  const double built = ThreadSeconds();
  const std::int64_t flow = algorithm(problem);
  return {flow, built - start, ThreadSeconds() - built};
}

}  // namespace

SolvedFlow SolveWithBoostBoykovKolmogorov(const MoveGraph& graph) {
  return Solve(graph, [](BoostProblem& p) {
    const std::size_t num_nodes = boost::num_vertices(p.graph);
    std::vector<EdgeDescriptor> predecessor(num_nodes);
    std::vector<boost::default_color_type> color(num_nodes);
    std::vector<std::int64_t> distance(num_nodes);
    return boost::boykov_kolmogorov_max_flow(p.graph, p.PerArc(p.capacity), p.PerArc(p.residual), p.PerArc(p.reverse),
                                             p.PerNode(predecessor), p.PerNode(color), p.PerNode(distance),
                                             boost::get(boost::vertex_index, p.graph), p.source, p.sink);
  });
}

SolvedFlow SolveWithBoostPushRelabel(const MoveGraph& graph) {
  return Solve(graph, [](BoostProblem& p) {
    return boost::push_relabel_max_flow(p.graph, p.source, p.sink, p.PerArc(p.capacity), p.PerArc(p.residual),
                                        p.PerArc(p.reverse), boost::get(boost::vertex_index, p.graph));
  });
}

}  // namespace depthfarm::benchmarks
