#include "worker/optimization/max_flow_push.h"

#include <algorithm>

namespace depthfarm {
namespace {

// In arcs that are looked at.
constexpr std::size_t kWorkOfNode = 4;         // to give a node another label, beside its own
constexpr std::size_t kLeastWork = 100;        // until all labels are found anew
constexpr std::size_t kWorkBetweenLabels = 1;  // of each arc that was looked at to find them

}  // namespace

MaxFlow::Push::Push(MaxFlow& graph, Node begin, Node end)
    : nodes_(graph.nodes_.data()), arcs_(graph.arcs_.data()), labels_(graph.labels_.data()), begin_(begin), end_(end) {}

std::int64_t MaxFlow::Push::Start(std::vector<Supply>& supplies) {
  std::int64_t all = 0;
  for (Node node = begin_; node < end_; ++node) all += std::max<std::int64_t>(nodes_[node].terminal, 0);
  for (Node node = begin_; node < end_; ++node)
    if (nodes_[node].terminal > 0) PushToNeighbours(node);
  supplies.clear();
  for (Node node = begin_; node < end_; ++node)
    if (nodes_[node].terminal > 0) supplies.push_back({node, nodes_[node].terminal});
  GoOn();
  return all;
}

void MaxFlow::Push::GoOn() {
  queue_.clear();
  for (Node node = begin_; node < end_; ++node) {
    labels_[node] = nodes_[node].terminal < 0 ? 0 : 1;
    nodes_[node].current = nodes_[node].first;
    if (nodes_[node].terminal > 0) queue_.push_back(node);
  }
  PushAll();
}

void MaxFlow::Push::PushToNeighbours(Node node) {
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
  }
}

void MaxFlow::Push::PushAll() {
  for (FindLabels(0); !queue_.empty();) {
    work_ = 0;
    const std::size_t most = kLeastWork + kWorkBetweenLabels * arcs_of_region_;
    std::size_t i = 0;
    for (; i < queue_.size() && work_ <= most; ++i) {  // it gets more meanwhile
      FetchAhead(queue_, i);
      Discharge(queue_[i]);
    }
    FindLabels(i);
  }
}

bool MaxFlow::Push::ReachNeighbours(Node node) {
  const std::size_t known = region_.size();
  for (Arc a = nodes_[node].first; a != EndOf(node); ++a) {
    const Node other = arcs_[a].head;
    if (arcs_[a].residual == 0 || !Sees(other) || labels_[other] >= kCut) continue;
    if (labels_[other] == 0) {
      region_.resize(known);
      return false;
    }
    region_.push_back(other);
  }
  // Several arcs may lead to one.
  std::size_t kept = known;
  for (std::size_t i = known; i < region_.size(); ++i) {
    const Node other = region_[i];
    if (labels_[other] == kUnknown) continue;
    labels_[other] = kUnknown;
    region_[kept++] = other;
  }
  region_.resize(kept);
  return true;
}

void MaxFlow::Push::FindLabels(std::size_t begin) {
  queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(begin));
  region_ = queue_;
  labelled_.clear();
  arcs_of_region_ = 0;
  for (const Node node : region_) labels_[node] = kUnknown;
  for (std::size_t i = 0; i < region_.size(); ++i) {  // it gets more meanwhile
    FetchAhead(region_, i);
    const Node node = region_[i];
    nodes_[node].current = nodes_[node].first;
    arcs_of_region_ += EndOf(node) - nodes_[node].first;
    if (!ReachNeighbours(node)) labelled_.push_back(node);
  }
  // From the sink back, a step at a time.
  for (const Node node : labelled_) labels_[node] = 1;
  for (std::size_t i = 0; i < labelled_.size(); ++i) {  // same
    FetchAhead(labelled_, i);
    const Node node = labelled_[i];
    for (Arc a = nodes_[node].first; a != EndOf(node); ++a) {
      const Node other = arcs_[a].head;
      if (!Sees(other) || labels_[other] != kUnknown || arcs_[arcs_[a].reverse].residual == 0) continue;
      labels_[other] = labels_[node] + 1;
      labelled_.push_back(other);
    }
  }
  if (labelled_.size() == region_.size()) return;
  for (const Node node : region_)
    if (labels_[node] == kUnknown) labels_[node] = kCut;
  std::erase_if(queue_, [this](Node node) { return labels_[node] == kCut; });
}

void MaxFlow::Push::Discharge(Node node) {
  NodeState& from = nodes_[node];
  const Arc end = EndOf(node);
  const Label below = labels_[node] - 1;
  for (; from.current != end; ++from.current) {
    ArcState& arc = arcs_[from.current];
    if (arc.residual == 0 || !Sees(arc.head) || labels_[arc.head] != below) continue;
    NodeState& to = nodes_[arc.head];
    const auto amount = static_cast<std::int32_t>(std::min<std::int64_t>(from.terminal, arc.residual));
    arc.residual -= amount;
    arcs_[arc.reverse].residual += amount;
    const std::int64_t before = to.terminal;
    to.terminal += amount;
    if (before < 0 && to.terminal >= 0) labels_[arc.head] = 1;
    if (before <= 0 && to.terminal > 0) queue_.push_back(arc.head);
    from.terminal -= amount;
    if (from.terminal == 0) return;
  }
  Label least = kCut;
  for (Arc a = from.first; a != end; ++a) {
    const Node other = arcs_[a].head;
    if (arcs_[a].residual != 0 && Sees(other)) least = std::min(least, labels_[other]);
  }
  work_ += end - from.first + kWorkOfNode;
  from.current = from.first;
  labels_[node] = least == kCut ? kCut : least + 1;
  if (least != kCut) queue_.push_back(node);
}

}  // namespace depthfarm
