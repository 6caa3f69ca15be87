#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace depthfarm {

// Minimum s-t cut by pushing: all that the source can give is pushed towards the sink at once, arc by arc, over the
// shortest ways, whose lengths are found anew from time to time (Goldberg and Tarjan, "A new approach to the
// maximum-flow problem", JACM 1988; Cherkassky and Goldberg, "On implementing the push-relabel method for the maximum
// flow problem", Algorithmica 1997), on flat index arrays that are reused from one problem to the next, a node's arcs
// side by side.
//
// In an expansion move nearly all nodes have a capacity to the sink themselves, so that what is pushed rarely goes far:
// ways are only looked for where there is something to push, and end next to such a node. Where there is none near, as
// on large surfaces without texture, augmenting paths would be many and long, and bring little each.
//
// The cut is canonical: the source side is exactly the set of nodes reachable from the source in the residual graph of
// a maximum flow, the smallest of all minimum cuts, whatever the order of the edges. So what does not reach the sink is
// pushed back to where it came from. Work: O(n^3); near linear on the graphs of expansion moves. Not thread-safe.
//
// In parts: the nodes are cut into ranges, to which threads can add edges side by side. On several threads ranges that
// follow each other and have about as many nodes are then solved side by side, without the arcs that leave them; in the
// end what is left is pushed over all arcs. A flow of some nodes is a flow of all, so that the cut is the same for any
// parts and threads. What is left in the end has to cross: parts should have few arcs between them, and most of them to
// the next.
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
      of.crossing[PartOf(v)].push_back({.edge = {u, v, capacity}, .from_u = 0, .from_v = 0});
    }
  }
  void AddEdge(Node u, Node v, std::int32_t capacity) { AddEdge(0, u, v, capacity); }

  // Computes the maximum flow, the parts on up to `threads` threads; call once after the edges are in. Returns its
  // value.
  std::int64_t Solve(int threads = 1);

  // After Solve: whether the node is on the source side of the canonical minimum cut.
  [[nodiscard]] bool InSourceSide(Node node) const { return labels_[node] == kSourceSide; }

 private:
  using Arc = std::uint32_t;  // index
  // Arcs on the way to the nearest node with capacity to the sink, or fewer, but 0 for these alone; or one of the three
  // below.
  using Label = std::int32_t;
  static constexpr Label kUnknown = std::numeric_limits<Label>::max();  // while labels are found
  static constexpr Label kCut = kUnknown - 1;                           // no way to the sink, now and ever
  static constexpr Label kSourceSide = kUnknown - 2;                    // after Solve

  struct NodeState {
    std::int64_t terminal = 0;  // what it has to push (> 0), or its residual capacity to the sink (< 0)
    Arc first = 0;              // its arcs are [first, the next node's first)
    Arc current = 0;            // those before this one lead nowhere with its label
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

  // What a node got from the source.
  struct Supply {
    Node node = 0;
    std::int64_t amount = 0;
  };

  struct Part {
    Node begin = 0;
    Node end = 0;
    std::vector<Edge> edges;                          // inside
    std::vector<std::vector<CrossingEdge>> crossing;  // from a node of it to one of each other part
    Arc first_arc = 0;
    [[nodiscard]] bool Holds(Node node) const { return node >= begin && node < end; }
  };
  class Push;

  [[nodiscard]] std::size_t PartOf(Node node) const;
  // Where each part's arcs begin.
  void PlaceParts();
  void BuildArcs(std::size_t part_index);
  // Tells the arcs from a part to others of each other.
  void JoinToOthers(Part& part);
  // Ranges of parts that are solved side by side: where each begins, and the end.
  [[nodiscard]] std::vector<Node> CutForThreads(int threads) const;
  // After all has been pushed: pushes what is left back to the nodes that got it from the source, until none has more
  // than it got and the flow is a maximum one. Returns how much that is.
  std::int64_t Return(std::span<const Node> cuts, int threads);
  void MarkSourceSide();

  Node num_nodes_ = 0;
  // These only grow, so that they are not zeroed anew for each problem.
  std::vector<NodeState> nodes_;  // and one more, whose `first` ends the arcs
  std::vector<ArcState> arcs_;
  std::vector<Label> labels_;  // per node
  std::vector<Arc> place_;     // of BuildArcs, per node

  std::vector<Part> parts_;
  std::vector<std::vector<Supply>> supplies_;  // per range: nodes that had something left after paths of one arc
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_H_
