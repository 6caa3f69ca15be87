#ifndef DEPTHFARM_WORKER_OPTIMIZATION_EXPANSION_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_EXPANSION_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/base/parallel.h"
#include "worker/optimization/labelling_problem.h"
#include "worker/optimization/max_flow.h"

namespace depthfarm {

// Alpha-expansion over the joint energy of eq. (1) (paper IV-B; Boykov, Veksler, Zabih 2001).
//
// In the move of level alpha every mover chooses between keeping its level (x = 0) and taking alpha (x = 1, source side
// of the cut). Every term is submodular: V is a metric, and each M term rewards an agreement of two nodes, -r x_s x_t
// (both take alpha) or -r (1 - x_s)(1 - x_t) (both keep). All other nodes are constants: their terms become terminal
// weights. So a move is exact on whatever nodes move, and never raises the energy.
//
// Symmetric normal form of a pairwise term: E00 + (E10 - E00 - c) x_s + (E01 - E00 - c) x_t + c [x_s != x_t] with
// c = (E01 + E10 - E00 - E11) / 2. For V, c = beta * (distance of alpha from the interval [d_s, d_t]); for M, c = r /
// 2: whole numbers, since beta and r are even. All capacities are symmetric, and few nodes start with flow.
//
// Of all labellings of least energy in a move the one that changes fewest nodes is taken (the canonical cut), so the
// result is a function of the problem alone. The graph holds the movers alone, and a move's work grows with them.
//
// On several threads (1 to 64) the nodes are cut into several times as many bands (BandsOf), which are gathered and
// built side by side, and as many ranges of bands cut so; then one thread ends the cut across ranges (MaxFlow). Labels
// are the same on any number of threads. Not thread-safe.
class Expansion {
 public:
  // `labels` holds the start (fixed nodes: their labels); free nodes must hold levels of the problem. Both must outlive
  // this.
  Expansion(const LabellingProblem& problem, std::vector<Level>& labels, int threads = 1);

  // One move to problem.levels[level]; every free node that does not hold it moves. Returns the change of energy, <= 0;
  // labels change only if it is < 0.
  std::int64_t Expand(std::size_t level);

  // The same of those of `nodes` that are free; each is there at most once. Work: of these nodes alone.
  std::int64_t ExpandAmong(std::size_t level, std::span<const NodeIndex> nodes);

  // The same of the free nodes that hold a level at most `band` (in indices of the problem's levels) from it, and those
  // they are linked to: adjacent ones, and their matches on the level. Work: of these nodes alone.
  std::int64_t ExpandNear(std::size_t level, std::size_t band);

  // E of eq. (1) of the labels, tracked move by move.
  [[nodiscard]] std::int64_t energy() const { return energy_; }

 private:
  using Place = std::uint32_t;  // of a match in held_
  static constexpr Place kNoPlace = std::numeric_limits<Place>::max();

  struct Link {  // V, from one of its ends
    NodeIndex other = 0;
    std::int32_t beta = 0;
  };

  void BuildLinks();
  void HoldMatches(NodeIndex node);
  // For each node who holds a match to it, and who holds each level: only moves of few nodes need it.
  void IndexHolders();
  void Enlist(Place place);
  void Delist(Place place);

  // The level that is moved to, and its index.
  struct Move {
    std::size_t level = 0;
    Level alpha = 0;
  };
  // The last move in which a node was a mover, and its number in that move's graph; one read for both.
  struct Mover {
    std::uint32_t time = 0;
    MaxFlow::Node number = 0;
  };
  // What a node of one part adds to the terminal of another's.
  struct Share {
    MaxFlow::Node node = 0;
    std::int64_t weight = 0;
  };
  struct Part {
    std::size_t index = 0;
    std::vector<NodeIndex> free;       // its nodes that are not fixed, ascending
    std::vector<NodeIndex> rewarding;  // its fixed nodes with a match on their own level whose target is free
    std::vector<std::vector<NodeIndex>> holders_of_level;  // made by IndexHolders: with those that have left since
    // Of the current move.
    std::vector<NodeIndex> near;
    std::vector<NodeIndex> near_elsewhere;  // what it gathers of other parts, as often as met
    std::vector<NodeIndex> movers;
    MaxFlow::Node first = 0;  // the first of its movers in the graph
    std::vector<Share> shares;
  };

  void GatherNear(Part& part, const Move& move, std::size_t band);
  void GatherFromOthers(Part& part);
  void Gather(Part& part, NodeIndex node) {
    if (gathered_[node] == time_) return;
    gathered_[node] = time_;
    part.near.push_back(node);
  }
  // Makes movers of nodes that are free and do not hold alpha.
  void ChooseMovers(Part& part, std::span<const NodeIndex> nodes, const Move& move);
  // A move of what the parts have gathered, in the index of holders.
  std::int64_t MoveGathered(const Move& move);
  // Makes a graph of the movers of all parts.
  void BeginGraph();
  void AddSmoothness(Part& part, NodeIndex node, const Move& move);
  void AddMatches(Part& part, NodeIndex node, const Move& move);
  // A constant node's reward depends only on its target: gained if that takes alpha, or lost if it leaves.
  void AddMatchOfConstant(Part& part, NodeIndex node, const MatchLink& match, const Move& move);
  // `node` moves.
  void AddToTerminal(Part& part, NodeIndex node, std::int64_t weight) {
    const MaxFlow::Node number = moves_[node].number;
    if (number - part.first < part.movers.size()) {
      terminal_[number] += weight;
    } else {
      part.shares.push_back({number, weight});
    }
  }
  // Calls each(part) for all parts, on as many threads.
  template <typename Each>
  void ForParts(const Each& each) {
    ParallelFor(parts_.size(), threads_, [&](std::size_t i) { each(parts_[i]); });
  }
  [[nodiscard]] bool IsOf(const Part& part, NodeIndex node) const {
    return part_of_.empty() || part_of_[node] == part.index;
  }
  [[nodiscard]] Part& PartOf(NodeIndex node) { return parts_[part_of_.empty() ? 0 : part_of_[node]]; }
  std::int64_t Solve(const Move& move);

  [[nodiscard]] bool Moves(NodeIndex node) const { return moves_[node].time == time_; }
  [[nodiscard]] std::int64_t& Terminal(NodeIndex node) { return terminal_[moves_[node].number]; }
  [[nodiscard]] MaxFlow::Node InGraph(NodeIndex node) const { return moves_[node].number; }
  [[nodiscard]] NodeIndex HolderOf(Place place) const { return place / static_cast<Place>(width_); }

  const LabellingProblem& problem_;
  std::vector<Level>& labels_;
  std::size_t width_;  // D, at least 1
  int threads_;
  std::vector<std::uint16_t> part_of_;  // per node; empty: there is one part
  std::vector<Part> parts_;
  std::vector<std::uint32_t> link_begin_;  // per node: where its links begin, and the end
  std::vector<Link> links_;                // of each node, but of pairs with at least one free end
  std::vector<MatchLink> held_;            // [node][slot]: the matches of each node on the level it holds

  // Made by IndexHolders: the places of held matches by their target, as lists.
  std::vector<Place> first_holder_;  // per node
  std::vector<Place> next_holder_;   // per place
  std::vector<Place> prior_holder_;  // per place
  bool indexed_ = false;

  // Of the current move.
  std::uint32_t time_ = 0;
  std::vector<Mover> moves_;             // per node
  std::vector<std::uint32_t> gathered_;  // per node: the last move in which it was gathered
  MaxFlow::Node num_movers_ = 0;
  std::vector<std::int64_t> terminal_;  // per mover: the linear coefficient of its x; only grows
  MaxFlow flow_;
  std::int64_t energy_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_EXPANSION_H_
