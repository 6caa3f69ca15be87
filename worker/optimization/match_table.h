#ifndef DEPTHFARM_WORKER_OPTIMIZATION_MATCH_TABLE_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_MATCH_TABLE_H_

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
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
// Eight bytes each, in chunks of nodes, so that threads can make parts of a table and none is ever copied to grow. In a
// chunk they lie level by level: a move asks for those of one level, and of nodes that lie near each other. Made by
// MatchTableBuilder.
class MatchTable {
 public:
  struct Match {
    NodeIndex target = 0;
    std::uint16_t reward = 0;  // match steps, > 0
    std::uint16_t level = 0;   // index into the problem's levels

    [[nodiscard]] std::int32_t RewardUnits() const { return reward * kEnergyUnitsPerMatchStep; }
    bool operator==(const Match&) const = default;
  };
  static constexpr NodeIndex kChunkNodes = 4096;  // smaller ones leave the process with more memory than it uses
  static constexpr int kMostPerLevel = 16;        // matches of a node on a level: of a view's neighbours

  // Appends the nodes of `part`. Only where this table is empty or a whole number of chunks.
  void Append(MatchTable part);

  [[nodiscard]] NodeIndex num_nodes() const { return num_nodes_; }
  // Matches of all nodes.
  [[nodiscard]] std::size_t size() const;

  // Matches of a node on a level, in the order they were added.
  [[nodiscard]] std::span<const Match> At(NodeIndex node, std::size_t level) const {
    const Chunk& chunk = chunks_[node / kChunkNodes];
    const std::size_t i = level - chunk.first_level;
    if (i >= chunk.levels.size() || chunk.levels[i].words == kNone) return {};
    const std::size_t bit = (node % kChunkNodes) << chunk.slot_bits;
    const std::size_t word = chunk.levels[i].words + bit / kWordBits;
    const std::uint64_t held = chunk.slots[word] >> (bit % kWordBits);
    if ((held & 1) == 0) return {};
    const std::uint64_t before = chunk.slots[word] & ((std::uint64_t{1} << (bit % kWordBits)) - 1);
    const std::size_t begin =
        chunk.levels[i].matches + chunk.before[word] + static_cast<std::size_t>(std::popcount(before));
    // They take the first slots of the node's.
    std::size_t count = 1;
    for (const std::size_t slots = std::size_t{1} << chunk.slot_bits; count < slots && (held >> count & 1) != 0;)
      ++count;
    return {chunk.matches.data() + begin, count};
  }

  // Calls visit(node, match) for all matches of the nodes [begin, end): of each node ascending by level.
  template <typename Visit>
  void ForEachOf(NodeIndex begin, NodeIndex end, const Visit& visit) const {
    for (NodeIndex first = begin; first < end;) {
      const NodeIndex next = std::min(end, (first / kChunkNodes + 1) * kChunkNodes);
      VisitIn(first / kChunkNodes, first % kChunkNodes, first % kChunkNodes + (next - first), visit);
      first = next;
    }
  }

  bool operator==(const MatchTable&) const = default;

 private:
  friend class MatchTableBuilder;

  static constexpr std::size_t kWordBits = 64;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  struct LevelOfChunk {
    std::uint32_t matches = 0;    // where they begin
    std::uint32_t words = kNone;  // where its slots begin; kNone: it has no matches
    bool operator==(const LevelOfChunk&) const = default;
  };
  struct Chunk {
    std::vector<Match> matches;  // level by level, in a level node by node
    std::size_t first_level = 0;
    std::vector<LevelOfChunk> levels;  // from the first with matches to the last
    // A level's slots: 2^slot_bits of each node, one after the other, as bits of words. 1: a match; a node's come first
    // in its slots.
    unsigned slot_bits = 0;
    std::vector<std::uint64_t> slots;
    std::vector<std::uint16_t> before;  // of each word: matches on its level in words before it
    static_assert(kChunkNodes * kMostPerLevel - kWordBits <= std::numeric_limits<std::uint16_t>::max());
    bool operator==(const Chunk&) const = default;
  };

  template <typename Visit>
  void VisitIn(std::size_t chunk_index, std::size_t begin, std::size_t end, const Visit& visit) const {
    const Chunk& chunk = chunks_[chunk_index];
    const auto first_node = static_cast<NodeIndex>(chunk_index * kChunkNodes);
    const std::size_t first_bit = begin << chunk.slot_bits;
    const std::size_t end_bit = end << chunk.slot_bits;
    for (const LevelOfChunk& level : chunk.levels) {
      if (level.words == kNone) continue;
      for (std::size_t word = first_bit / kWordBits; word * kWordBits < end_bit; ++word) {
        std::uint64_t held = chunk.slots[level.words + word];
        std::size_t match = level.matches + chunk.before[level.words + word];
        if (word * kWordBits < first_bit) {
          const std::uint64_t before = held & ((std::uint64_t{1} << (first_bit % kWordBits)) - 1);
          match += static_cast<std::size_t>(std::popcount(before));
          held ^= before;
        }
        for (; held != 0; held &= held - 1) {
          const std::size_t bit = word * kWordBits + static_cast<std::size_t>(std::countr_zero(held));
          if (bit >= end_bit) break;
          visit(first_node + static_cast<NodeIndex>(bit >> chunk.slot_bits), chunk.matches[match++]);
        }
      }
    }
  }

  std::vector<Chunk> chunks_;
  NodeIndex num_nodes_ = 0;
};

// Makes a table node by node.
class MatchTableBuilder {
 public:
  // most_per_level: matches of a node on one level at most, 1 to kMostPerLevel.
  explicit MatchTableBuilder(int most_per_level);

  // To the node that is being appended, levels ascending; one without a reward is left out. At most most_per_level of
  // one level.
  void Add(std::size_t level, NodeIndex target, std::uint16_t reward) {
    if (reward != 0) open_.push_back({target, reward, static_cast<std::uint16_t>(level)});
  }
  // The node is whole; the next one begins.
  void EndNode();
  // The table of all nodes that have ended.
  [[nodiscard]] MatchTable Take() &&;

 private:
  void EndChunk();
  // Where each level's matches and slots begin in the chunk; next_ begins where the matches do.
  void PlaceLevels(MatchTable::Chunk& chunk);
  void PlaceMatches(MatchTable::Chunk& chunk);
  [[nodiscard]] std::size_t WordsOfLevel() const {
    return ((ends_.size() << slot_bits_) + MatchTable::kWordBits - 1) / MatchTable::kWordBits;
  }

  unsigned slot_bits_;
  MatchTable table_;
  std::vector<MatchTable::Match> open_;  // of the chunk that is being filled, node by node
  std::vector<std::size_t> ends_;        // of its nodes in it
  std::vector<std::uint32_t> next_;      // of EndChunk: per level, where its next match goes
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_MATCH_TABLE_H_
