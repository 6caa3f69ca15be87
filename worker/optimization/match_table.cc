#include "worker/optimization/match_table.h"

#include <iterator>
#include <utility>

namespace depthfarm {

void MatchTable::Append(MatchTable part) {
  num_nodes_ += part.num_nodes_;
  std::move(part.chunks_.begin(), part.chunks_.end(), std::back_inserter(chunks_));
}

std::size_t MatchTable::size() const {
  std::size_t size = 0;
  for (const Chunk& chunk : chunks_) size += chunk.matches.size();
  return size;
}

MatchTableBuilder::MatchTableBuilder(int most_per_level)
    : slot_bits_(static_cast<unsigned>(
          std::bit_width(static_cast<unsigned>(std::clamp(most_per_level, 1, MatchTable::kMostPerLevel)) - 1))) {}

void MatchTableBuilder::EndNode() {
  ends_.push_back(open_.size());
  if (ends_.size() == MatchTable::kChunkNodes) EndChunk();
}

MatchTable MatchTableBuilder::Take() && {
  if (!ends_.empty()) EndChunk();
  return std::move(table_);
}

void MatchTableBuilder::EndChunk() {
  MatchTable::Chunk& chunk = table_.chunks_.emplace_back();
  chunk.slot_bits = slot_bits_;
  table_.num_nodes_ += static_cast<NodeIndex>(ends_.size());
  if (!open_.empty()) {
    PlaceLevels(chunk);
    PlaceMatches(chunk);
  }
  open_.clear();
  ends_.clear();
}

void MatchTableBuilder::PlaceLevels(MatchTable::Chunk& chunk) {
  const auto by_level = [](const MatchTable::Match& a, const MatchTable::Match& b) { return a.level < b.level; };
  const auto [lowest, highest] = std::minmax_element(open_.begin(), open_.end(), by_level);
  chunk.first_level = lowest->level;
  chunk.levels.resize(highest->level - chunk.first_level + 1);
  next_.assign(chunk.levels.size(), 0);
  for (const MatchTable::Match& match : open_) ++next_[match.level - chunk.first_level];
  std::uint32_t matches = 0;
  std::size_t words = 0;
  for (std::size_t level = 0; level < chunk.levels.size(); ++level) {
    const std::uint32_t count = std::exchange(next_[level], matches);
    if (count == 0) continue;
    chunk.levels[level] = {.matches = matches, .words = static_cast<std::uint32_t>(words)};
    matches += count;
    words += WordsOfLevel();
  }
  chunk.matches.resize(open_.size());
  chunk.slots.resize(words);
  chunk.before.resize(words);
}

void MatchTableBuilder::PlaceMatches(MatchTable::Chunk& chunk) {
  auto match = open_.cbegin();
  for (std::size_t node = 0; node < ends_.size(); ++node) {
    const auto end = open_.cbegin() + static_cast<std::ptrdiff_t>(ends_[node]);
    std::size_t slot = 0;
    for (std::size_t level = chunk.levels.size(); match != end; ++match) {
      slot = match->level - chunk.first_level == level ? slot + 1 : 0;
      level = match->level - chunk.first_level;
      const std::size_t bit = (node << slot_bits_) + slot;
      chunk.slots[chunk.levels[level].words + bit / MatchTable::kWordBits] |= std::uint64_t{1}
                                                                              << (bit % MatchTable::kWordBits);
      chunk.matches[next_[level]++] = *match;
    }
  }
  for (const MatchTable::LevelOfChunk& level : chunk.levels) {
    if (level.words == MatchTable::kNone) continue;
    int sum = 0;
    for (std::size_t word = level.words; word < level.words + WordsOfLevel(); ++word) {
      chunk.before[word] = static_cast<std::uint16_t>(sum);
      sum += std::popcount(chunk.slots[word]);
    }
  }
}

}  // namespace depthfarm
