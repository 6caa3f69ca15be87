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
  nodes_.resize(std::size_t{bounds.back()} + 1);
  place_.resize(nodes_.size());
  labels_.resize(nodes_.size());
  parts_.resize(bounds.size() - 1);
  ParallelFor(parts_.size(), threads, [&](std::size_t i) {
    Part& part = parts_[i];
    part.begin = bounds[i];
    part.end = bounds[i + 1];
    part.edges.clear();
    part.crossing.clear();
    std::fill(nodes_.begin() + part.begin, nodes_.begin() + part.end, NodeState{});
  });
}

void MaxFlow::PlaceParts() {
  std::vector<Arc> sizes;
  for (const Part& part : parts_) sizes.push_back(static_cast<Arc>(2 * part.edges.size() + part.crossing.size()));
  for (const Part& part : parts_) {
    for (const CrossingEdge& crossing : part.crossing) {
      const auto other =
          std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.Holds(crossing.edge.v); });
      ++sizes[static_cast<std::size_t>(other - parts_.begin())];
    }
  }
  Arc sum = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    parts_[i].first_arc = sum;
    sum += sizes[i];
  }
  arcs_.resize(sum);
  nodes_.back().first = sum;
}

// Sorted by node, so that a node's arcs lie side by side.
void MaxFlow::BuildArcs(Part& part) {
  std::fill(place_.begin() + part.begin, place_.begin() + part.end, Arc{0});
  for (const Edge& edge : part.edges) {
    ++place_[edge.u];
    ++place_[edge.v];
  }
  // Calls visit(node of this part, the other, capacity, place of the arc's number) for its ends of crossing edges.
  const auto for_each_crossing = [&](const auto& visit) {
    for (Part& other : parts_) {
      for (CrossingEdge& crossing : other.crossing) {
        const Edge& edge = crossing.edge;
        if (&other == &part) visit(edge.u, edge.v, edge.capacity, crossing.from_u);
        if (&other != &part && part.Holds(edge.v)) visit(edge.v, edge.u, edge.capacity, crossing.from_v);
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

void MaxFlow::JoinParts() {
  for (const Part& part : parts_) {
    for (const CrossingEdge& crossing : part.crossing) {
      arcs_[crossing.from_u].reverse = crossing.from_v;
      arcs_[crossing.from_v].reverse = crossing.from_u;
    }
  }
}

void MaxFlow::MarkSourceSide() {
  std::vector<Node> reached;
  for (Node node = 0; node + 1 < nodes_.size(); ++node) {
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

std::int64_t MaxFlow::Solve(int threads) {
  PlaceParts();
  // One after the other: the first node of the next part tells where the arcs of the last node of a part end.
  ParallelFor(parts_.size(), threads, [&](std::size_t i) { BuildArcs(parts_[i]); });
  std::vector<std::vector<Push::Supply>> supplies(parts_.size());
  std::vector<std::int64_t> given(parts_.size());
  ParallelFor(parts_.size(), threads,
              [&](std::size_t i) { given[i] = Push(*this, parts_[i].begin, parts_[i].end).Start(supplies[i]); });
  Push whole(*this, 0, static_cast<Node>(nodes_.size() - 1));
  if (parts_.size() > 1) {
    JoinParts();
    whole.GoOn();
    for (std::size_t i = 1; i < parts_.size(); ++i)
      supplies.front().insert(supplies.front().end(), supplies[i].begin(), supplies[i].end());
  }
  const std::int64_t flow =
      std::accumulate(given.begin(), given.end(), std::int64_t{0}) - whole.Return(std::move(supplies.front()));
  MarkSourceSide();
  return flow;
}

}  // namespace depthfarm
