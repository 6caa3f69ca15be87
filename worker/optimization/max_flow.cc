#include "worker/optimization/max_flow.h"

#include <algorithm>
#include <array>

#include "common/base/parallel.h"

namespace depthfarm {

// Grows the tree of the source over a range of nodes; arcs that leave the range are not seen. Searches of ranges that
// do not overlap may run at once.
class MaxFlow::Search {
 public:
  Search(MaxFlow& graph, Node begin, Node end, SearchState& state)
      : nodes_(graph.nodes_.data()), arcs_(graph.arcs_.data()), begin_(begin), size_(end - begin), state_(state) {}

  // From nothing.
  void Start();
  // From what searches of parts of the range left: `ends` are nodes whose arcs were not all seen.
  void GoOn(std::span<const Node> ends);

 private:
  // Paths of one arc, before there is a tree: many nodes get rid of all they have from the source.
  void SendToNeighbours(Node node);
  void MakeActive(Node node);
  void ScanAll();
  // Grows the tree from a node, and sends flow to the sink where it can.
  void Scan(Node node);
  // Sends what the path from the source over an arc out of the tree to the sink takes.
  void Augment(Arc last);
  void MakeOrphan(Node node);
  // Gives every orphan another parent or takes it out of the tree.
  void AdoptOrphans();
  void Adopt(Node node);
  // Distance of a node to the source if its path reaches it without an orphan, else -1; stamps the path.
  [[nodiscard]] std::int32_t DistanceToSource(Node node);
  [[nodiscard]] Arc EndOf(Node node) const { return nodes_[node + 1].first; }
  [[nodiscard]] bool Sees(Node node) const { return node - begin_ < size_; }

  NodeState* const nodes_;
  ArcState* const arcs_;
  const Node begin_;
  const Node size_;
  SearchState& state_;
};

void MaxFlow::Search::SendToNeighbours(Node node) {
  NodeState& from = nodes_[node];
  for (Arc a = from.first; a != EndOf(node) && from.terminal > 0; ++a) {
    if (!Sees(arcs_[a].head)) continue;
    NodeState& to = nodes_[arcs_[a].head];
    if (to.terminal >= 0) continue;
    const std::int64_t amount = std::min({from.terminal, std::int64_t{arcs_[a].residual}, -to.terminal});
    from.terminal -= amount;
    to.terminal += amount;
    arcs_[a].residual -= static_cast<std::int32_t>(amount);
    arcs_[arcs_[a].reverse].residual += static_cast<std::int32_t>(amount);
    state_.flow += amount;
  }
}

void MaxFlow::Search::MakeActive(Node node) {
  if (nodes_[node].is_active) return;
  nodes_[node].is_active = true;
  state_.active.push_back(node);
}

void MaxFlow::Search::Scan(Node node) {
  const Arc end = EndOf(node);
  for (Arc a = nodes_[node].first; a != end; ++a) {
    if (arcs_[a].residual == 0) continue;
    const Node other = arcs_[a].head;
    if (!Sees(other)) continue;
    NodeState& to = nodes_[other];
    if (to.parent != kNone) {
      const NodeState& from = nodes_[node];
      if (to.stamp <= from.stamp && to.distance > from.distance + 1) {  // a shorter way to the source
        to.parent = arcs_[a].reverse;
        to.stamp = from.stamp;
        to.distance = from.distance + 1;
      }
      continue;
    }
    if (to.terminal < 0) {
      ++state_.time;
      Augment(a);
      AdoptOrphans();
      if (nodes_[node].parent == kNone) return;
      if (arcs_[a].residual == 0 || to.terminal < 0) {  // again, over another way to the source
        --a;
        continue;
      }
    }
    to.parent = arcs_[a].reverse;
    to.stamp = nodes_[node].stamp;
    to.distance = nodes_[node].distance + 1;
    MakeActive(other);
  }
}

void MaxFlow::Search::Augment(Arc last) {
  Node node = arcs_[arcs_[last].reverse].head;
  NodeState& end = nodes_[arcs_[last].head];
  std::int64_t amount = std::min<std::int64_t>(arcs_[last].residual, -end.terminal);
  Node walker = node;
  for (Arc up = nodes_[walker].parent; up != kTerminal; up = nodes_[walker].parent) {
    amount = std::min<std::int64_t>(amount, arcs_[arcs_[up].reverse].residual);
    walker = arcs_[up].head;
  }
  amount = std::min(amount, nodes_[walker].terminal);

  const auto step = static_cast<std::int32_t>(amount);  // at most the last arc's residual
  arcs_[last].residual -= step;
  arcs_[arcs_[last].reverse].residual += step;
  end.terminal += amount;
  for (Arc up = nodes_[node].parent; up != kTerminal;) {
    ArcState& down = arcs_[arcs_[up].reverse];
    arcs_[up].residual += step;
    down.residual -= step;
    const Node parent = arcs_[up].head;
    if (down.residual == 0) MakeOrphan(node);
    node = parent;
    up = nodes_[node].parent;
  }
  nodes_[node].terminal -= amount;
  if (nodes_[node].terminal == 0) MakeOrphan(node);
  state_.flow += amount;
}

void MaxFlow::Search::MakeOrphan(Node node) {
  nodes_[node].parent = kOrphan;
  state_.orphans.push_back(node);
}

void MaxFlow::Search::AdoptOrphans() {
  for (std::size_t i = 0; i < state_.orphans.size(); ++i) Adopt(state_.orphans[i]);  // they get more meanwhile
  state_.orphans.clear();
}

std::int32_t MaxFlow::Search::DistanceToSource(Node node) {
  std::int32_t distance = 0;
  Node walker = node;
  for (;;) {
    if (nodes_[walker].stamp == state_.time) {
      distance += nodes_[walker].distance;
      break;
    }
    const Arc up = nodes_[walker].parent;
    ++distance;
    if (up == kTerminal) {
      nodes_[walker].stamp = state_.time;
      nodes_[walker].distance = 1;
      break;
    }
    if (up == kOrphan || up == kNone) return -1;
    walker = arcs_[up].head;
  }
  // Mark the path, so that the next search stops where it meets it.
  std::int32_t remaining = distance;
  for (walker = node; nodes_[walker].stamp != state_.time; walker = arcs_[nodes_[walker].parent].head) {
    nodes_[walker].stamp = state_.time;
    nodes_[walker].distance = remaining--;
  }
  return distance;
}

void MaxFlow::Search::Adopt(Node node) {
  NodeState& orphan = nodes_[node];
  const Arc end = EndOf(node);
  Arc best = kNone;
  std::int32_t best_distance = std::numeric_limits<std::int32_t>::max();
  for (Arc a = orphan.first; a != end; ++a) {
    if (!Sees(arcs_[a].head)) continue;
    const NodeState& other = nodes_[arcs_[a].head];
    if (other.parent >= kOrphan && other.parent != kTerminal) continue;
    if (arcs_[arcs_[a].reverse].residual == 0) continue;
    const std::int32_t distance = DistanceToSource(arcs_[a].head);
    if (distance >= 0 && distance < best_distance) {
      best = a;
      best_distance = distance;
      if (distance < orphan.distance) break;  // as near as before
    }
  }
  orphan.parent = best;
  if (best != kNone) {
    orphan.stamp = state_.time;
    orphan.distance = best_distance + 1;
    return;
  }
  for (Arc a = orphan.first; a != end; ++a) {
    const Node other = arcs_[a].head;
    if (!Sees(other)) continue;
    NodeState& state = nodes_[other];
    if (state.parent == kNone) continue;
    if (arcs_[arcs_[a].reverse].residual != 0) MakeActive(other);  // it could grow back to this node
    if (state.parent == arcs_[a].reverse) MakeOrphan(other);
  }
}

void MaxFlow::Search::ScanAll() {
  for (std::size_t i = 0; i < state_.active.size(); ++i) {  // it gets more meanwhile
    const Node node = state_.active[i];
    nodes_[node].is_active = false;
    if (nodes_[node].parent != kNone) Scan(node);
  }
  state_.active.clear();
}

void MaxFlow::Search::Start() {
  const Node end = begin_ + size_;
  for (Node node = begin_; node < end; ++node) {
    if (nodes_[node].terminal > 0) SendToNeighbours(node);
  }
  for (Node node = begin_; node < end; ++node) {
    if (nodes_[node].terminal <= 0) continue;
    nodes_[node].distance = 1;
    nodes_[node].parent = kTerminal;
    MakeActive(node);
  }
  ScanAll();
}

void MaxFlow::Search::GoOn(std::span<const Node> ends) {
  for (const Node node : ends) {
    if (nodes_[node].parent != kNone) MakeActive(node);
  }
  ScanAll();
}

void MaxFlow::Reset(Node num_nodes) { Reset(std::array<Node, 2>{0, num_nodes}, 1); }

void MaxFlow::Reset(std::span<const Node> bounds, int threads) {
  nodes_.resize(std::size_t{bounds.back()} + 1);
  place_.resize(nodes_.size());
  parts_.resize(bounds.size() - 1);
  ParallelFor(parts_.size(), threads, [&](std::size_t i) {
    Part& part = parts_[i];
    part.begin = bounds[i];
    part.end = bounds[i + 1];
    part.edges.clear();
    part.crossing.clear();
    part.search.time = 0;
    part.search.flow = 0;
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

std::vector<MaxFlow::Node> MaxFlow::EndsOfCrossingEdges() const {
  std::vector<Node> ends;
  for (const Part& part : parts_)
    for (const CrossingEdge& crossing : part.crossing) ends.insert(ends.end(), {crossing.edge.u, crossing.edge.v});
  return ends;
}

std::int64_t MaxFlow::Solve(int threads) {
  PlaceParts();
  // One after the other: the first node of the next part tells where the arcs of the last node of a part end.
  ParallelFor(parts_.size(), threads, [&](std::size_t i) { BuildArcs(parts_[i]); });
  ParallelFor(parts_.size(), threads,
              [&](std::size_t i) { Search(*this, parts_[i].begin, parts_[i].end, parts_[i].search).Start(); });
  SearchState& last = parts_.front().search;
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    last.time = std::max(last.time, parts_[i].search.time);
    last.flow += parts_[i].search.flow;
  }
  if (parts_.size() > 1) {
    JoinParts();
    Search(*this, 0, static_cast<Node>(nodes_.size() - 1), last).GoOn(EndsOfCrossingEdges());
  }
  return last.flow;
}

}  // namespace depthfarm
