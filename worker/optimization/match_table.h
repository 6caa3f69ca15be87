#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MATCH_TABLE_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MATCH_TABLE_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "worker/cost/energy_units.h"

namespace depthfarm {

// A segment of any view of a frame: the segments of all views in one numbering.
using NodeIndex = std::uint32_t;

// M of eq. (5) in one direction: a segment that holds some level is rewarded by `reward` match steps if `target` holds
// the same level. reward 0: no match there. The relation is not symmetric: the target's own match is another term.
struct MatchLink {
  NodeIndex target = 0;
  std::uint16_t reward = 0;

  [[nodiscard]] std::int32_t RewardUnits() const { return reward * kEnergyUnitsPerMatchStep; }
};

// The matches of every node on every level, those without a reward left out: with uniqueness three quarters of them.
// Node by node, ascending by level, eight bytes each; in chunks of nodes, so that threads can make parts of a table and
// none is ever copied to grow.
class MatchTable {
 public:
  struct Match {
    NodeIndex target = 0;
    std::uint16_t reward = 0;  // match steps, > 0
    std::uint16_t level = 0;   // index into the problem's levels

    [[nodiscard]] std::int32_t RewardUnits() const { return reward * kEnergyUnitsPerMatchStep; }
    bool operator==(const Match&) const = default;
  };
  static constexpr NodeIndex kChunkNodes = 4096;

  // To the node that is being appended, levels ascending; one without a reward is left out.
  void Add(std::size_t level, NodeIndex target, std::uint16_t reward) {
    if (reward != 0) open_.push_back({target, reward, static_cast<std::uint16_t>(level)});
  }
  // The node is whole; the next one begins.
  void EndNode();
  // Appends the nodes of `part`. Only where this table is empty or a whole number of chunks.
  void Append(MatchTable part);

  [[nodiscard]] NodeIndex num_nodes() const { return num_nodes_; }
  // Matches of all nodes.
  [[nodiscard]] std::size_t size() const;

  // Matches of a node, ascending by level; of one level in the order they were added.
  [[nodiscard]] std::span<const Match> Of(NodeIndex node) const {
    const Chunk& chunk = chunks_[node / kChunkNodes];
    const NodeIndex i = node % kChunkNodes;
    return {chunk.matches.data() + chunk.begin[i], chunk.matches.data() + chunk.begin[i + 1]};
  }
  // Those on one level. Mostly there are none, which one word of the node tells.
  [[nodiscard]] std::span<const Match> At(NodeIndex node, std::size_t level) const;

  bool operator==(const MatchTable&) const = default;

 private:
  struct Chunk {
    std::vector<Match> matches;
    std::vector<std::uint32_t> begin = {0};  // of each node, and the end
    std::vector<std::uint64_t> levels;       // of each node: bit l % 64 where it has matches on level l
    bool operator==(const Chunk&) const = default;
  };
  std::vector<Chunk> chunks_;
  std::vector<Match> open_;  // of the node that is being appended
  NodeIndex num_nodes_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MATCH_TABLE_H_
