#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace depthfarm {

// Minimum s-t cut by augmenting paths from a search tree of the source that is mended after each of them (as one of the
// two trees of Boykov and Kolmogorov, "An experimental comparison of min-cut/max-flow algorithms", PAMI 2004), on flat
// index arrays that are reused from one problem to the next, a node's arcs side by side.
//
// There is no tree of the sink: in an expansion move nearly all nodes have a capacity to it themselves, so that a path
// ends as soon as it leaves the source tree, and most nodes are never looked at.
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
  void AddEdge(Node u, Node v, std::int32_t capacity) {
    if (capacity > 0) edges_.push_back({u, v, capacity});
  }

  // Computes the maximum flow; call once after the edges are in. Returns its value.
  std::int64_t Solve();

  // After Solve: whether the node is on the source side of the canonical minimum cut.
  [[nodiscard]] bool InSourceSide(Node node) const { return nodes_[node].parent != kNone; }

 private:
  using Arc = std::uint32_t;                                         // index
  static constexpr Arc kTerminal = std::numeric_limits<Arc>::max();  // child of the source itself
  static constexpr Arc kNone = kTerminal - 1;                        // not in the tree
  static constexpr Arc kOrphan = kTerminal - 2;

  struct NodeState {
    std::int64_t terminal = 0;  // residual capacity from the source (> 0) or to the sink (< 0)
    Arc first = 0;              // its arcs are [first, the next node's first)
    Arc parent = kNone;         // arc from the node to its parent
    std::int32_t distance = 0;  // to the source, an upper bound valid at `stamp`
    std::int32_t stamp = 0;
    bool is_active = false;  // in the queue of nodes to scan
  };
  struct ArcState {
    Node head = 0;
    Arc reverse = 0;
    std::int32_t residual = 0;
  };
  struct Edge {
    Node u = 0;
    Node v = 0;
    std::int32_t capacity = 0;
  };

  void BuildArcs();
  // Paths of one arc, before there is a tree: many nodes get rid of all they have from the source.
  void SendToNeighbours(Node node);
  void MakeActive(Node node);
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

  std::vector<NodeState> nodes_;  // and one more, whose `first` ends the arcs
  std::vector<Edge> edges_;
  std::vector<ArcState> arcs_;
  std::vector<Arc> place_;     // of BuildArcs
  std::vector<Node> active_;   // a queue: nodes to scan
  std::vector<Node> orphans_;  // a queue
  std::int32_t time_ = 0;
  std::int64_t flow_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
