#include "tests/support/cut_oracle.h"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <cstdlib>
#include <map>
#include <queue>
#include <utility>

namespace depthfarm::test {
namespace {

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using VertexProperties =
    boost::property<boost::vertex_color_t, boost::default_color_type,
                    boost::property<boost::vertex_distance_t, std::int64_t,
                                    boost::property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>;
using Graph = boost::adjacency_list<
    boost::vecS, boost::vecS, boost::directedS, VertexProperties,
    boost::property<boost::edge_capacity_t, std::int64_t,
                    boost::property<boost::edge_residual_capacity_t, std::int64_t,
                                    boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;

void AddArcPair(Graph& graph, std::size_t u, std::size_t v, std::int64_t forth, std::int64_t back) {
  const auto a = boost::add_edge(u, v, graph).first;
  const auto b = boost::add_edge(v, u, graph).first;
  boost::put(boost::edge_capacity, graph, a, forth);
  boost::put(boost::edge_capacity, graph, b, back);
  boost::put(boost::edge_reverse, graph, a, b);
  boost::put(boost::edge_reverse, graph, b, a);
}

std::vector<bool> ReachableFromSource(const Graph& graph, std::size_t source, std::size_t num_nodes) {
  std::vector<bool> seen(boost::num_vertices(graph), false);
  std::queue<std::size_t> queue;
  queue.push(source);
  seen[source] = true;
  while (!queue.empty()) {
    const std::size_t node = queue.front();
    queue.pop();
    for (auto [edge, end] = boost::out_edges(node, graph); edge != end; ++edge) {
      const std::size_t target = boost::target(*edge, graph);
      if (boost::get(boost::edge_residual_capacity, graph, *edge) > 0 && !seen[target]) {
        seen[target] = true;
        queue.push(target);
      }
    }
  }
  seen.resize(num_nodes);
  return seen;
}

// E as a function of binary x: constant + linear terms + pairwise tables, from the definitions of eqs. (2) and (5).
class BinaryEnergy {
 public:
  explicit BinaryEnergy(std::size_t num_nodes) : linear_(num_nodes, 0) {}

  // value[xs][xt]; a node that cannot change has both rows (columns) equal to its x = 0 one.
  void AddPair(std::size_t s, std::size_t t, const std::int64_t (&value)[2][2]) {
    // Kolmogorov-Zabih: E00 + (E10 - E00) xs + (E11 - E10) xt + (E01 + E10 - E00 - E11) (1 - xs) xt.
    linear_[s] += value[1][0] - value[0][0];
    linear_[t] += value[1][1] - value[1][0];
    const std::int64_t weight = value[0][1] + value[1][0] - value[0][0] - value[1][1];
    if (weight < 0) std::abort();              // the oracle only ever sees submodular terms
    if (weight > 0) pairs_[{t, s}] += weight;  // paid when t is on the source side and s is not
  }

  [[nodiscard]] CutProblem ToCut() const {
    CutProblem cut;
    cut.from_source.assign(linear_.size(), 0);
    cut.to_sink.assign(linear_.size(), 0);
    for (std::size_t i = 0; i < linear_.size(); ++i) {
      (linear_[i] < 0 ? cut.from_source[i] : cut.to_sink[i]) = std::abs(linear_[i]);
    }
    for (const auto& [nodes, weight] : pairs_) {
      cut.edges.push_back({static_cast<int>(nodes.first), static_cast<int>(nodes.second), weight, 0});
    }
    return cut;
  }

 private:
  std::vector<std::int64_t> linear_;
  std::map<std::pair<std::size_t, std::size_t>, std::int64_t> pairs_;
};

}  // namespace

CutSolution SolveCutPlainly(const CutProblem& problem) {
  const std::size_t num_nodes = problem.from_source.size();
  const std::size_t source = num_nodes;
  const std::size_t sink = num_nodes + 1;
  Graph graph(num_nodes + 2);
  for (std::size_t i = 0; i < num_nodes; ++i) {
    AddArcPair(graph, source, i, problem.from_source[i], 0);
    AddArcPair(graph, i, sink, problem.to_sink[i], 0);
  }
  for (const CutProblem::Edge& edge : problem.edges) {
    AddArcPair(graph, static_cast<std::size_t>(edge.u), static_cast<std::size_t>(edge.v), edge.forth, edge.back);
  }
  CutSolution solution;
  solution.flow = boost::boykov_kolmogorov_max_flow(graph, source, sink);
  solution.source_side = ReachableFromSource(graph, source, num_nodes);
  return solution;
}

std::int64_t EnergyPlainly(const LabellingProblem& problem, const std::vector<Level>& labels) {
  std::int64_t energy = 0;
  for (const SmoothnessLink& link : problem.smoothness) {
    energy += std::int64_t{link.beta} * std::abs(int{labels[link.first]} - int{labels[link.second]});
  }
  for (std::size_t l = 0; l < problem.levels.size(); ++l) {
    for (NodeIndex s = 0; s < problem.num_nodes; ++s) {
      for (const MatchTable::Match& match : problem.matches.At(s, l)) {
        const bool agree = labels[s] == problem.levels[l] && labels[match.target] == problem.levels[l];
        if (agree) energy -= std::int64_t{match.reward} * 128;
      }
    }
  }
  return energy;
}

std::vector<Level> ExpandPlainly(const LabellingProblem& problem, const std::vector<Level>& labels, Level alpha) {
  const auto label = [&](NodeIndex node, int x) { return x == 1 && problem.fixed[node] == 0 ? alpha : labels[node]; };
  BinaryEnergy energy(problem.num_nodes);
  for (const SmoothnessLink& link : problem.smoothness) {
    std::int64_t value[2][2];
    for (const int xs : {0, 1}) {
      for (const int xt : {0, 1}) {
        value[xs][xt] = std::int64_t{link.beta} * std::abs(int{label(link.first, xs)} - int{label(link.second, xt)});
      }
    }
    energy.AddPair(link.first, link.second, value);
  }
  for (std::size_t l = 0; l < problem.levels.size(); ++l) {
    for (NodeIndex s = 0; s < problem.num_nodes; ++s) {
      for (const MatchTable::Match& match : problem.matches.At(s, l)) {
        std::int64_t value[2][2];
        for (const int xs : {0, 1}) {
          for (const int xt : {0, 1}) {
            const bool agree = label(s, xs) == problem.levels[l] && label(match.target, xt) == problem.levels[l];
            value[xs][xt] = agree ? -std::int64_t{match.reward} * 128 : 0;
          }
        }
        energy.AddPair(s, match.target, value);
      }
    }
  }
  const CutSolution cut = SolveCutPlainly(energy.ToCut());
  std::vector<Level> result = labels;
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    if (cut.source_side[node]) result[node] = label(node, 1);
  }
  return result;
}

}  // namespace depthfarm::test
