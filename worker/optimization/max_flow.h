#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace depthfarm {

// Minimum s-t cut by augmenting paths between two search trees (Boykov and Kolmogorov, "An experimental comparison of
// min-cut/max-flow algorithms", PAMI 2004), on flat index arrays that are reused from one problem to the next.
//
// The cut is canonical: the source side is exactly the set of nodes reachable from the source in the residual graph,
// the smallest of all minimum cuts, whatever the order of the edges. (When the search ends, nothing can grow: every
// residual arc out of the source tree stays inside it, so the tree is that set.) Work: worst case pseudo-polynomial;
// near linear on the graphs of expansion moves. Not thread-safe.
class MaxFlow {
 public:
  using Node = std::uint32_t;

  // Forgets everything and makes nodes 0 .. num_nodes - 1 without edges. Keeps the memory.
  void Reset(Node num_nodes);

  // Adds to a node's terminal weight: a positive sum is a capacity from the source, a negative one a capacity to the
  // sink.
  void AddTerminal(Node node, std::int64_t weight) { nodes_[node].terminal += weight; }

  // Adds edges u -> v and v -> u with the same capacity, >= 0. Parallel edges are allowed. The sum of a pair's
  // capacities must stay below 2^30.
  void AddEdge(Node u, Node v, std::int32_t capacity);

  // Computes the maximum flow; call once after the edges are in. Returns its value.
  std::int64_t Solve();

  // After Solve: whether the node is on the source side of the canonical minimum cut.
  [[nodiscard]] bool InSourceSide(Node node) const {
    return nodes_[node].parent != kNoArc && !nodes_[node].in_sink_tree;
  }

 private:
  using Arc = std::int32_t;             // index; a ^ 1 is the reverse arc
  static constexpr Arc kNoArc = -1;     // node in no tree
  static constexpr Arc kTerminal = -2;  // child of the source or the sink itself
  static constexpr Arc kOrphan = -3;
  static constexpr Node kNotActive = 0xFFFFFFFF;  // not in the queue of active nodes

  struct NodeState {
    std::int64_t terminal = 0;  // residual capacity from the source (> 0) or to the sink (< 0)
    Arc first = kNoArc;
    Arc parent = kNoArc;        // arc from the node to its parent
    std::int32_t distance = 0;  // to the terminal, an upper bound valid at `stamp`
    std::int32_t stamp = 0;
    Node next_active = kNotActive;  // the node itself: last of the queue
    bool in_sink_tree = false;
  };
  struct ArcState {
    Node head = 0;
    Arc next = kNoArc;
    std::int32_t residual = 0;
  };

  void PlantTrees();
  void MakeActive(Node node);
  [[nodiscard]] Node TakeActive();
  // Grows the tree of an active node; returns an arc from the source tree to the sink tree, or kNoArc.
  [[nodiscard]] Arc Grow(Node node);
  [[nodiscard]] std::int64_t Bottleneck(Arc bridge) const;
  void Augment(Arc bridge);
  void MakeOrphan(Node node);
  void AdoptOrphans();
  void Adopt(Node node);
  // Distance of `node` to its terminal if its path reaches it without an orphan, else -1; stamps the path.
  [[nodiscard]] std::int32_t DistanceToTerminal(Node node);
  // Residual capacity of the tree arc between a node and a possible parent, in the direction of the flow.
  [[nodiscard]] std::int32_t TreeResidual(Arc to_parent, bool in_sink_tree) const {
    return in_sink_tree ? arcs_[static_cast<std::size_t>(to_parent)].residual
                        : arcs_[static_cast<std::size_t>(to_parent ^ 1)].residual;
  }
  [[nodiscard]] ArcState& arc(Arc a) { return arcs_[static_cast<std::size_t>(a)]; }
  [[nodiscard]] const ArcState& arc(Arc a) const { return arcs_[static_cast<std::size_t>(a)]; }

  std::vector<NodeState> nodes_;
  std::vector<ArcState> arcs_;
  std::vector<Node> orphans_;  // a FIFO: [orphan_head_, size)
  std::size_t orphan_head_ = 0;
  Node queue_first_ = kNotActive;  // nodes found now
  Node queue_last_ = kNotActive;
  std::int64_t flow_ = 0;
  std::int32_t time_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
