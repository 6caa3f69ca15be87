#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
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
//
// In parts: the nodes are cut into ranges, each of which is solved without the arcs that leave it, so that threads can
// do this side by side; then one search goes on over all arcs from the trees of the parts (Liu and Sun, "Parallel
// graph-cuts by adaptive bottom-up merging", CVPR 2010). A flow of a part is a flow of the whole, so that the cut is
// the same for any parts. What is left for the last search is what has to cross: parts should have few arcs between
// them.
class MaxFlow {
 public:
  using Node = std::uint32_t;

  // Forgets everything and makes nodes 0 .. num_nodes - 1 without edges, in one part. Keeps the memory.
  void Reset(Node num_nodes);
  // The same in parts: the i-th is the nodes [bounds[i], bounds[i + 1]). bounds: ascending, from 0, at least two.
  void Reset(std::span<const Node> bounds, int threads);

  // Adds to a node's terminal weight: a positive sum is a capacity from the source, a negative one a capacity to the
  // sink.
  void AddTerminal(Node node, std::int64_t weight) { nodes_[node].terminal += weight; }

  // Adds edges u -> v and v -> u with the same capacity, >= 0. Parallel edges are allowed. The sum of a pair's
  // capacities must stay below 2^30. `part`: the one that u is in; calls for different parts may be made at once.
  void AddEdge(std::size_t part, Node u, Node v, std::int32_t capacity) {
    if (capacity <= 0) return;
    Part& of = parts_[part];
    if (of.Holds(v)) {
      of.edges.push_back({u, v, capacity});
    } else {
      of.crossing.push_back({.edge = {u, v, capacity}, .from_u = 0, .from_v = 0});
    }
  }
  void AddEdge(Node u, Node v, std::int32_t capacity) { AddEdge(0, u, v, capacity); }

  // Computes the maximum flow, the parts on up to `threads` threads; call once after the edges are in. Returns its
  // value.
  std::int64_t Solve(int threads = 1);

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
  struct CrossingEdge {
    Edge edge;
    Arc from_u = 0;
    Arc from_v = 0;
  };

  // Queues of a search, and how far it has come.
  struct SearchState {
    std::vector<Node> active;   // a queue: nodes to scan
    std::vector<Node> orphans;  // a queue
    std::int32_t time = 0;
    std::int64_t flow = 0;
  };
  struct Part {
    Node begin = 0;
    Node end = 0;
    std::vector<Edge> edges;             // inside
    std::vector<CrossingEdge> crossing;  // from a node of it to one of another part
    Arc first_arc = 0;
    SearchState search;
    [[nodiscard]] bool Holds(Node node) const { return node >= begin && node < end; }
  };
  class Search;

  // Where each part's arcs begin.
  void PlaceParts();
  void BuildArcs(Part& part);
  // Tells the arcs between parts of each other.
  void JoinParts();
  [[nodiscard]] std::vector<Node> EndsOfCrossingEdges() const;

  std::vector<NodeState> nodes_;  // and one more, whose `first` ends the arcs
  std::vector<Part> parts_;
  std::vector<ArcState> arcs_;
  std::vector<Arc> place_;  // of BuildArcs, per node
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
