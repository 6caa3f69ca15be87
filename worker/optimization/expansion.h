#ifndef DEPTHFARM_WORKER_OPTIMIZATION_EXPANSION_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_EXPANSION_H_

#include <cstdint>
#include <stop_token>
#include <vector>

#include "worker/optimization/labelling_problem.h"
#include "worker/optimization/max_flow.h"

namespace depthfarm {

// Alpha-expansion over the joint energy of eq. (1) (paper IV-B; Boykov, Veksler, Zabih 2001).
//
// In the move of level alpha every free node that does not hold alpha chooses between keeping its level (x = 0) and
// taking alpha (x = 1, source side of the cut). Every term is submodular: V is a metric, and each M term rewards an
// agreement of two nodes, -r x_s x_t (both take alpha) or -r (1 - x_s)(1 - x_t) (both keep). Nodes that are fixed or
// hold alpha already are constants: their terms become terminal weights.
//
// Symmetric normal form of a pairwise term: E00 + (E10 - E00 - c) x_s + (E01 - E00 - c) x_t + c [x_s != x_t] with
// c = (E01 + E10 - E00 - E11) / 2. For V, c = beta * (distance of alpha from the interval [d_s, d_t]); for M, c = r /
// 2: whole numbers, since beta and r are even. All capacities are symmetric, and few nodes start with flow.
//
// Of all labellings of least energy in a move the one that changes fewest nodes is taken (the canonical cut), so the
// result is a function of the problem alone. The graph holds the free nodes alone, and a move's work grows with them,
// not with the fixed ones (nearly all in a P frame). Not thread-safe.
class Expansion {
 public:
  // `labels` holds the start (fixed nodes: their labels); free nodes must hold levels of the problem. Both must outlive
  // this.
  Expansion(const LabellingProblem& problem, std::vector<Level>& labels);

  // One move to problem.levels[level_index]. Returns the change of energy, <= 0; labels change only if it is < 0.
  std::int64_t Expand(std::size_t level_index);

  // E of eq. (1) of the labels, tracked move by move.
  [[nodiscard]] std::int64_t energy() const { return energy_; }

 private:
  void AddSmoothness(Level alpha);
  void AddMatches(std::size_t level_index, Level alpha);
  void AddMatchesOfConstant(NodeIndex node, Level alpha);
  void AddMatchesOfFree(NodeIndex node, const MatchLink* at_alpha, Level alpha);
  void HoldMatches(NodeIndex node, const MatchLink* matches);
  [[nodiscard]] bool IsConstant(NodeIndex node, Level alpha) const {
    return problem_.fixed[node] != 0 || labels_[node] == alpha;
  }
  // The linear coefficient of x of a free node, and that node in the graph.
  [[nodiscard]] std::int64_t& Terminal(NodeIndex node) { return terminal_[in_graph_[node]]; }
  [[nodiscard]] MaxFlow::Node InGraph(NodeIndex node) const { return in_graph_[node]; }

  const LabellingProblem& problem_;
  std::vector<Level>& labels_;
  std::vector<NodeIndex> free_;             // not fixed, ascending
  std::vector<MaxFlow::Node> in_graph_;     // per node: its place in free_; of fixed nodes meaningless
  std::vector<SmoothnessLink> smoothness_;  // with at least one free end
  std::vector<NodeIndex> rewarding_;        // fixed nodes with a match on their own level whose target is free
  std::vector<MatchLink> held_;             // [node][slot]: the matches of each node on the level it holds
  std::vector<std::int64_t> terminal_;      // per free node, of the current move
  MaxFlow flow_;
  std::int64_t energy_ = 0;
};

struct ExpansionSummary {
  int sweeps = 0;
  std::int64_t moves = 0;  // that lowered the energy
  std::int64_t energy = 0;
  bool cancelled = false;
};

// Sweeps over all levels, up and down in turn, until no move lowers E, or max_sweeps (0 = no limit). A level is not
// tried again while nothing has changed since its last try (its move would find the same problem).
[[nodiscard]] ExpansionSummary ExpandToConvergence(const LabellingProblem& problem, std::vector<Level>& labels,
                                                   int max_sweeps, const std::stop_token& stop);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_EXPANSION_H_
