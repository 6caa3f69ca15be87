#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_PUSH_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_PUSH_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "worker/optimization/max_flow.h"

namespace depthfarm {

// Pushes what the nodes of a range have towards the sink, and back what does not arrive. Arcs that leave the range are
// not seen: of ranges that do not overlap it may be done at once.
class MaxFlow::Push {
 public:
  Push(MaxFlow& graph, Node begin, Node end);

  // Pushes all that the source gives; returns how much that is. Sets `supplies` to the nodes that had something left
  // after paths of one arc, and how much.
  std::int64_t Start(std::vector<Supply>& supplies);
  // After Start, of this range or of parts of it: pushes what is left.
  void GoOn();

 private:
  static constexpr std::size_t kNodesAhead = 8;
  static constexpr std::size_t kArcsAhead = 4;

  // Paths of one arc first: many nodes get rid of all they have.
  void PushToNeighbours(Node node);
  // Until nothing that nodes of the queue have has a way to the sink.
  void PushAll();
  // Of FindLabels: adds the nodes that an arc of `node` leads to and that are not in the region. None, and false, where
  // one of them takes something. Inline: FindLabels is slower where it is a call.
  [[gnu::always_inline]] inline bool ReachNeighbours(Node node);
  // Finds the labels of all nodes that what the queue has from `begin` on comes to on its ways to the sink, and leaves
  // those of the queue that have a way. Work: of these nodes alone. Behind one that is next to the sink nodes keep the
  // labels they have, which are never too large: most of what comes there goes no farther.
  void FindLabels(std::size_t begin);
  // Pushes what the node has, until it has nothing or gets another label.
  void Discharge(Node node);
  // Asks memory for nodes that have their turn soon after the i-th, and for their arcs: they lie anywhere. Inline
  // because GCC 12 takes a function that only prefetches for one without an effect, and leaves its calls out.
  [[gnu::always_inline]] void FetchAhead(const std::vector<Node>& nodes, std::size_t i) const {
    if (i + kNodesAhead >= nodes.size()) return;
    __builtin_prefetch(&nodes_[nodes[i + kNodesAhead]]);
    const ArcState* arcs = &arcs_[nodes_[nodes[i + kArcsAhead]].first];
    __builtin_prefetch(arcs);
    __builtin_prefetch(arcs + 5);
  }
  [[nodiscard]] bool Sees(Node node) const { return node - begin_ < end_ - begin_; }
  [[nodiscard]] Arc EndOf(Node node) const { return nodes_[node + 1].first; }

  NodeState* const nodes_;
  ArcState* const arcs_;
  Label* const labels_;
  const Node begin_;
  const Node end_;
  std::vector<Node> queue_;     // those that have something to push, each once, and those that had
  std::vector<Node> region_;    // of FindLabels
  std::vector<Node> labelled_;  // same
  std::size_t arcs_of_region_ = 0;
  std::size_t work_ = 0;  // arcs looked at for single labels since all were found
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MAX_FLOW_PUSH_H_
