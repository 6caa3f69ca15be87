#include "worker/optimization/max_flow.h"

#include <algorithm>

namespace depthfarm {

void MaxFlow::Reset(Node num_nodes) {
  nodes_.assign(std::size_t{num_nodes} + 1, NodeState{});
  edges_.clear();
  flow_ = 0;
  time_ = 0;
}

// Sorted by node, so that a node's arcs lie side by side.
void MaxFlow::BuildArcs() {
  const std::size_t num_nodes = nodes_.size() - 1;
  place_.assign(num_nodes + 1, 0);
  for (const Edge& edge : edges_) {
    ++place_[edge.u];
    ++place_[edge.v];
  }
  Arc sum = 0;
  for (std::size_t node = 0; node <= num_nodes; ++node) {
    nodes_[node].first = sum;
    const Arc count = place_[node];
    place_[node] = sum;
    sum += count;
  }
  arcs_.resize(sum);
  for (const Edge& edge : edges_) {
    const Arc forth = place_[edge.u]++;
    const Arc back = place_[edge.v]++;
    arcs_[forth] = {edge.v, back, edge.capacity};
    arcs_[back] = {edge.u, forth, edge.capacity};
  }
}

void MaxFlow::SendToNeighbours(Node node) {
  NodeState& from = nodes_[node];
  for (Arc a = from.first; a != EndOf(node) && from.terminal > 0; ++a) {
    NodeState& to = nodes_[arcs_[a].head];
    if (to.terminal >= 0) continue;
    const std::int64_t amount = std::min({from.terminal, std::int64_t{arcs_[a].residual}, -to.terminal});
    from.terminal -= amount;
    to.terminal += amount;
    arcs_[a].residual -= static_cast<std::int32_t>(amount);
    arcs_[arcs_[a].reverse].residual += static_cast<std::int32_t>(amount);
    flow_ += amount;
  }
}

void MaxFlow::MakeActive(Node node) {
  if (nodes_[node].is_active) return;
  nodes_[node].is_active = true;
  active_.push_back(node);
}

void MaxFlow::Scan(Node node) {
  const Arc end = EndOf(node);
  for (Arc a = nodes_[node].first; a != end; ++a) {
    if (arcs_[a].residual == 0) continue;
    const Node other = arcs_[a].head;
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
      ++time_;
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

void MaxFlow::Augment(Arc last) {
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
  flow_ += amount;
}

void MaxFlow::MakeOrphan(Node node) {
  nodes_[node].parent = kOrphan;
  orphans_.push_back(node);
}

void MaxFlow::AdoptOrphans() {
  for (std::size_t i = 0; i < orphans_.size(); ++i) Adopt(orphans_[i]);  // they get more meanwhile
  orphans_.clear();
}

std::int32_t MaxFlow::DistanceToSource(Node node) {
  std::int32_t distance = 0;
  Node walker = node;
  for (;;) {
    if (nodes_[walker].stamp == time_) {
      distance += nodes_[walker].distance;
      break;
    }
    const Arc up = nodes_[walker].parent;
    ++distance;
    if (up == kTerminal) {
      nodes_[walker].stamp = time_;
      nodes_[walker].distance = 1;
      break;
    }
    if (up == kOrphan || up == kNone) return -1;
    walker = arcs_[up].head;
  }
  // Mark the path, so that the next search stops where it meets it.
  std::int32_t remaining = distance;
  for (walker = node; nodes_[walker].stamp != time_; walker = arcs_[nodes_[walker].parent].head) {
    nodes_[walker].stamp = time_;
    nodes_[walker].distance = remaining--;
  }
  return distance;
}

void MaxFlow::Adopt(Node node) {
  NodeState& orphan = nodes_[node];
  const Arc end = EndOf(node);
  Arc best = kNone;
  std::int32_t best_distance = std::numeric_limits<std::int32_t>::max();
  for (Arc a = orphan.first; a != end; ++a) {
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
    orphan.stamp = time_;
    orphan.distance = best_distance + 1;
    return;
  }
  for (Arc a = orphan.first; a != end; ++a) {
    const Node other = arcs_[a].head;
    NodeState& state = nodes_[other];
    if (state.parent == kNone) continue;
    if (arcs_[arcs_[a].reverse].residual != 0) MakeActive(other);  // it could grow back to this node
    if (state.parent == arcs_[a].reverse) MakeOrphan(other);
  }
}

std::int64_t MaxFlow::Solve() {
  BuildArcs();
  active_.clear();
  const auto num_nodes = static_cast<Node>(nodes_.size() - 1);
  for (Node node = 0; node < num_nodes; ++node) {
    if (nodes_[node].terminal > 0) SendToNeighbours(node);
  }
  for (Node node = 0; node < num_nodes; ++node) {
    if (nodes_[node].terminal <= 0) continue;
    nodes_[node].distance = 1;
    nodes_[node].parent = kTerminal;
    MakeActive(node);
  }
  for (std::size_t i = 0; i < active_.size(); ++i) {  // it gets more meanwhile
    const Node node = active_[i];
    nodes_[node].is_active = false;
    if (nodes_[node].parent != kNone) Scan(node);
  }
  return flow_;
}

}  // namespace depthfarm
