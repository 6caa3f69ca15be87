#include "worker/optimization/match_table.h"

#include <algorithm>
#include <iterator>

namespace depthfarm {

void MatchTable::EndNode() {
  if (num_nodes_ % kChunkNodes == 0) {
    if (!chunks_.empty()) chunks_.back().matches.shrink_to_fit();
    chunks_.emplace_back();
    chunks_.back().begin.reserve(kChunkNodes + 1);
    chunks_.back().levels.reserve(kChunkNodes);
  }
  Chunk& chunk = chunks_.back();
  chunk.begin.push_back(chunk.begin.back() + static_cast<std::uint32_t>(open_.size()));
  std::uint64_t levels = 0;
  for (const Match& match : open_) levels |= std::uint64_t{1} << (match.level % 64U);
  chunk.levels.push_back(levels);
  chunk.matches.insert(chunk.matches.end(), open_.begin(), open_.end());
  open_.clear();
  ++num_nodes_;
}

void MatchTable::Append(MatchTable part) {
  num_nodes_ += part.num_nodes_;
  std::move(part.chunks_.begin(), part.chunks_.end(), std::back_inserter(chunks_));
}

std::size_t MatchTable::size() const {
  std::size_t size = 0;
  for (const Chunk& chunk : chunks_) size += chunk.matches.size();
  return size;
}

std::span<const MatchTable::Match> MatchTable::At(NodeIndex node, std::size_t level) const {
  const std::uint64_t levels = chunks_[node / kChunkNodes].levels[node % kChunkNodes];
  if ((levels >> (level % 64) & 1) == 0) return {};
  const std::span<const Match> all = Of(node);
  const auto below = [](const Match& match, std::size_t bound) { return match.level < bound; };
  const auto begin = std::lower_bound(all.begin(), all.end(), level, below);
  auto end = begin;
  while (end != all.end() && end->level == level) ++end;
  return {begin, end};
}

}  // namespace depthfarm
