#include "worker/optimization/max_flow.h"

#include <algorithm>
#include <limits>

namespace depthfarm {

void MaxFlow::Reset(Node num_nodes) {
  nodes_.assign(num_nodes, NodeState{});
  arcs_.clear();
  orphans_.clear();
  orphan_head_ = 0;
  queue_first_ = queue_last_ = kNotActive;
  flow_ = 0;
  time_ = 0;
}

void MaxFlow::AddEdge(Node u, Node v, std::int32_t capacity) {
  const Arc forth = static_cast<Arc>(arcs_.size());
  arcs_.push_back({v, nodes_[u].first, capacity});
  arcs_.push_back({u, nodes_[v].first, capacity});
  nodes_[u].first = forth;
  nodes_[v].first = forth + 1;
}

void MaxFlow::PlantTrees() {
  for (Node node = 0; node < nodes_.size(); ++node) {
    NodeState& state = nodes_[node];
    if (state.terminal == 0) continue;
    state.in_sink_tree = state.terminal < 0;
    state.parent = kTerminal;
    state.distance = 1;
    MakeActive(node);
  }
}

void MaxFlow::MakeActive(Node node) {
  if (nodes_[node].next_active != kNotActive) return;
  if (queue_last_ == kNotActive) {
    queue_first_ = node;
  } else {
    nodes_[queue_last_].next_active = node;
  }
  queue_last_ = node;
  nodes_[node].next_active = node;
}

MaxFlow::Node MaxFlow::TakeActive() {
  while (queue_first_ != kNotActive) {
    const Node node = queue_first_;
    const Node next = nodes_[node].next_active;
    if (next == node) {
      queue_first_ = queue_last_ = kNotActive;
    } else {
      queue_first_ = next;
    }
    nodes_[node].next_active = kNotActive;
    if (nodes_[node].parent != kNoArc) return node;  // else it has left its tree since
  }
  return kNotActive;
}

MaxFlow::Arc MaxFlow::Grow(Node node) {
  const NodeState& from = nodes_[node];
  for (Arc a = from.first; a != kNoArc; a = arc(a).next) {
    const std::int32_t residual = from.in_sink_tree ? arc(a ^ 1).residual : arc(a).residual;
    if (residual == 0) continue;
    const Node other = arc(a).head;
    NodeState& to = nodes_[other];
    if (to.parent == kNoArc) {
      to.in_sink_tree = from.in_sink_tree;
      to.parent = a ^ 1;
      to.stamp = from.stamp;
      to.distance = from.distance + 1;
      MakeActive(other);
    } else if (to.in_sink_tree != from.in_sink_tree) {
      return from.in_sink_tree ? (a ^ 1) : a;
    } else if (to.stamp <= from.stamp && to.distance > from.distance + 1) {
      to.parent = a ^ 1;  // a shorter way to the terminal
      to.stamp = from.stamp;
      to.distance = from.distance + 1;
    }
  }
  return kNoArc;
}

std::int64_t MaxFlow::Bottleneck(Arc bridge) const {
  std::int64_t bottleneck = arc(bridge).residual;
  Node node = arc(bridge ^ 1).head;
  for (Arc up = nodes_[node].parent; up != kTerminal; up = nodes_[node].parent) {
    bottleneck = std::min<std::int64_t>(bottleneck, arc(up ^ 1).residual);
    node = arc(up).head;
  }
  bottleneck = std::min(bottleneck, nodes_[node].terminal);
  node = arc(bridge).head;
  for (Arc up = nodes_[node].parent; up != kTerminal; up = nodes_[node].parent) {
    bottleneck = std::min<std::int64_t>(bottleneck, arc(up).residual);
    node = arc(up).head;
  }
  return std::min(bottleneck, -nodes_[node].terminal);
}

void MaxFlow::Augment(Arc bridge) {
  const std::int64_t amount = Bottleneck(bridge);
  const auto step = static_cast<std::int32_t>(amount);  // at most the bridge's residual
  arc(bridge).residual -= step;
  arc(bridge ^ 1).residual += step;

  Node node = arc(bridge ^ 1).head;
  for (Arc up = nodes_[node].parent; up != kTerminal;) {
    arc(up).residual += step;
    arc(up ^ 1).residual -= step;
    const Node parent = arc(up).head;
    if (arc(up ^ 1).residual == 0) MakeOrphan(node);
    node = parent;
    up = nodes_[node].parent;
  }
  nodes_[node].terminal -= amount;
  if (nodes_[node].terminal == 0) MakeOrphan(node);

  node = arc(bridge).head;
  for (Arc up = nodes_[node].parent; up != kTerminal;) {
    arc(up ^ 1).residual += step;
    arc(up).residual -= step;
    const Node parent = arc(up).head;
    if (arc(up).residual == 0) MakeOrphan(node);
    node = parent;
    up = nodes_[node].parent;
  }
  nodes_[node].terminal += amount;
  if (nodes_[node].terminal == 0) MakeOrphan(node);
  flow_ += amount;
}

void MaxFlow::MakeOrphan(Node node) {
  nodes_[node].parent = kOrphan;
  orphans_.push_back(node);
}

void MaxFlow::AdoptOrphans() {
  while (orphan_head_ < orphans_.size()) Adopt(orphans_[orphan_head_++]);
  orphans_.clear();
  orphan_head_ = 0;
}

std::int32_t MaxFlow::DistanceToTerminal(Node node) {
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
    if (up == kOrphan || up == kNoArc) return -1;
    walker = arc(up).head;
  }
  // Mark the path, so that the next search stops where it meets it.
  std::int32_t remaining = distance;
  for (walker = node; nodes_[walker].stamp != time_; walker = arc(nodes_[walker].parent).head) {
    nodes_[walker].stamp = time_;
    nodes_[walker].distance = remaining--;
  }
  return distance;
}

void MaxFlow::Adopt(Node node) {
  NodeState& orphan = nodes_[node];
  Arc best = kNoArc;
  std::int32_t best_distance = std::numeric_limits<std::int32_t>::max();
  for (Arc a = orphan.first; a != kNoArc; a = arc(a).next) {
    if (TreeResidual(a, orphan.in_sink_tree) == 0) continue;
    const NodeState& other = nodes_[arc(a).head];
    if (other.parent == kNoArc || other.parent == kOrphan || other.in_sink_tree != orphan.in_sink_tree) continue;
    const std::int32_t distance = DistanceToTerminal(arc(a).head);
    if (distance >= 0 && distance < best_distance) {
      best = a;
      best_distance = distance;
    }
  }
  if (best != kNoArc) {
    orphan.parent = best;
    orphan.stamp = time_;
    orphan.distance = best_distance + 1;
    return;
  }
  orphan.parent = kNoArc;
  for (Arc a = orphan.first; a != kNoArc; a = arc(a).next) {
    const Node other = arc(a).head;
    NodeState& state = nodes_[other];
    if (state.parent == kNoArc || state.in_sink_tree != orphan.in_sink_tree) continue;
    if (TreeResidual(a, orphan.in_sink_tree) != 0) MakeActive(other);  // it could grow back to this node
    if (state.parent >= 0 && arc(state.parent).head == node) MakeOrphan(other);
  }
}

std::int64_t MaxFlow::Solve() {
  PlantTrees();
  Node current = kNotActive;
  for (;;) {
    // The node whose growth met the other tree goes on growing while it stays in a tree.
    if (current == kNotActive || nodes_[current].parent == kNoArc) {
      current = TakeActive();
      if (current == kNotActive) return flow_;
    }
    const Arc bridge = Grow(current);
    if (bridge == kNoArc) {
      current = kNotActive;
      continue;
    }
    ++time_;
    Augment(bridge);
    AdoptOrphans();
  }
}

}  // namespace depthfarm
