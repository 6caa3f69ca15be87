#include "worker/optimization/max_flow.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "common/base/parallel.h"
#include "worker/optimization/max_flow_push.h"

namespace depthfarm {

void MaxFlow::Reset(Node num_nodes) { Reset(std::array<Node, 2>{0, num_nodes}, 1); }

void MaxFlow::Reset(std::span<const Node> bounds, int threads) {
  num_nodes_ = bounds.back();
  if (nodes_.size() <= num_nodes_) {
    nodes_.resize(std::size_t{num_nodes_} + 1);
    place_.resize(num_nodes_);
    labels_.resize(num_nodes_);
  }
  parts_.resize(bounds.size() - 1);
  ParallelFor(parts_.size(), threads, [&](std::size_t i) {
    Part& part = parts_[i];
    part.begin = bounds[i];
    part.end = bounds[i + 1];
    part.edges.clear();
    part.crossing.resize(parts_.size());
    for (std::vector<CrossingEdge>& crossing : part.crossing) crossing.clear();
    std::fill(nodes_.begin() + part.begin, nodes_.begin() + part.end, NodeState{});
  });
}

std::size_t MaxFlow::PartOf(Node node) const {
  const auto after = std::upper_bound(parts_.begin(), parts_.end(), node,
                                      [](Node searched, const Part& part) { return searched < part.end; });
  return static_cast<std::size_t>(after - parts_.begin());
}

void MaxFlow::PlaceParts() {
  Arc sum = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    parts_[i].first_arc = sum;
    sum += static_cast<Arc>(2 * parts_[i].edges.size());
    for (std::size_t other = 0; other < parts_.size(); ++other) {
      sum += static_cast<Arc>(parts_[i].crossing[other].size() + parts_[other].crossing[i].size());
    }
  }
  if (arcs_.size() < sum) arcs_.resize(sum);
  nodes_[num_nodes_].first = sum;
}

// Sorted by node, so that a node's arcs lie side by side.
void MaxFlow::BuildArcs(std::size_t part_index) {
  Part& part = parts_[part_index];
  std::fill(place_.begin() + part.begin, place_.begin() + part.end, Arc{0});
  for (const Edge& edge : part.edges) {
    ++place_[edge.u];
    ++place_[edge.v];
  }
  // Calls visit(node of this part, the other, capacity, place of the arc's number) for its ends of crossing edges.
  const auto for_each_crossing = [&](const auto& visit) {
    for (std::vector<CrossingEdge>& to_other : part.crossing) {
      for (CrossingEdge& crossing : to_other) {
        const Edge& edge = crossing.edge;
        visit(edge.u, edge.v, edge.capacity, crossing.from_u);
      }
    }
    for (Part& other : parts_) {
      for (CrossingEdge& crossing : other.crossing[part_index]) {
        const Edge& edge = crossing.edge;
        visit(edge.v, edge.u, edge.capacity, crossing.from_v);
      }
    }
  };
  for_each_crossing([&](Node node, Node, std::int32_t, Arc&) { ++place_[node]; });
  Arc sum = part.first_arc;
  for (Node node = part.begin; node < part.end; ++node) {
    nodes_[node].first = sum;
    const Arc count = place_[node];
    place_[node] = sum;
    sum += count;
  }
  for (const Edge& edge : part.edges) {
    const Arc forth = place_[edge.u]++;
    const Arc back = place_[edge.v]++;
    arcs_[forth] = {edge.v, back, edge.capacity};
    arcs_[back] = {edge.u, forth, edge.capacity};
  }
  for_each_crossing([&](Node node, Node other, std::int32_t capacity, Arc& number) {
    number = place_[node]++;
    arcs_[number] = {other, 0, capacity};
  });
}

void MaxFlow::JoinToOthers(Part& part) {
  for (const std::vector<CrossingEdge>& to_other : part.crossing) {
    for (const CrossingEdge& crossing : to_other) {
      arcs_[crossing.from_u].reverse = crossing.from_v;
      arcs_[crossing.from_v].reverse = crossing.from_u;
    }
  }
}

std::vector<MaxFlow::Node> MaxFlow::CutForThreads(int threads) const {
  const auto most = static_cast<std::size_t>(std::max(threads, 1));
  std::vector<Node> cuts{0};
  for (const Part& part : parts_) {
    // Before the part in whose first half a range should end, or behind that in whose second half it should.
    const std::size_t wanted = cuts.size() * std::size_t{num_nodes_} / most;
    if (cuts.size() < most && part.begin > cuts.back() && part.begin + std::size_t{part.end} > 2 * wanted) {
      cuts.push_back(part.begin);
    }
  }
  cuts.push_back(num_nodes_);
  return cuts;
}

void MaxFlow::MarkSourceSide() {
  std::vector<Node> reached;
  for (Node node = 0; node < num_nodes_; ++node) {
    if (nodes_[node].terminal > 0) reached.push_back(node);
    labels_[node] = nodes_[node].terminal > 0 ? kSourceSide : 0;
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {  // it gets more meanwhile
    for (Arc a = nodes_[reached[i]].first; a != nodes_[reached[i] + 1].first; ++a) {
      if (arcs_[a].residual == 0 || labels_[arcs_[a].head] == kSourceSide) continue;
      labels_[arcs_[a].head] = kSourceSide;
      reached.push_back(arcs_[a].head);
    }
  }
}

std::int64_t MaxFlow::Return(std::span<const Node> cuts, int threads) {
  // Nodes that have something yet are cut from the sink. Each keeps of it what it got itself; the rest goes to nodes
  // that passed on what they got.
  std::int64_t all = 0;
  for (Node node = 0; node < num_nodes_; ++node) all += std::max<std::int64_t>(nodes_[node].terminal, 0);
  for (std::vector<Supply>& supplies : supplies_) {
    std::erase_if(supplies, [this](const Supply& supply) { return labels_[supply.node] != kCut; });
    for (const Supply& supply : supplies) nodes_[supply.node].terminal -= supply.amount;
  }
  if (cuts.size() > 2) {
    ParallelFor(cuts.size() - 1, threads, [&](std::size_t i) { Push(*this, cuts[i], cuts[i + 1]).GoOn(); });
  }
  Push(*this, 0, num_nodes_).GoOn();
  for (const std::vector<Supply>& supplies : supplies_)
    for (const Supply& supply : supplies) nodes_[supply.node].terminal += supply.amount;
  return all;
}

std::int64_t MaxFlow::Solve(int threads) {
  PlaceParts();
  // One after the other: the first node of the next part tells where the arcs of the last node of a part end.
  ParallelFor(parts_.size(), threads, [&](std::size_t i) { BuildArcs(i); });
  ParallelFor(parts_.size(), threads, [&](std::size_t i) { JoinToOthers(parts_[i]); });
  const std::vector<Node> cuts = CutForThreads(threads);
  std::vector<std::int64_t> given(cuts.size() - 1);
  supplies_.resize(given.size());
  ParallelFor(given.size(), threads,
              [&](std::size_t i) { given[i] = Push(*this, cuts[i], cuts[i + 1]).Start(supplies_[i]); });
  if (given.size() > 1) Push(*this, 0, num_nodes_).GoOn();
  const std::int64_t flow = std::accumulate(given.begin(), given.end(), std::int64_t{0}) - Return(cuts, threads);
  MarkSourceSide();
  return flow;
}

}  // namespace depthfarm
