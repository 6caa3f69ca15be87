#ifndef DEPTHFARM_TESTS_SUPPORT_MATCH_LISTS_H_
#define DEPTHFARM_TESTS_SUPPORT_MATCH_LISTS_H_

#include <cstddef>
#include <utility>
#include <vector>

#include "worker/optimization/match_table.h"

namespace depthfarm::test {

// A table from matches written out as [level][node][slot], those without a reward too.
inline MatchTable TableOf(const std::vector<MatchLink>& matches, std::size_t num_levels, NodeIndex num_nodes,
                          std::size_t slots) {
  MatchTableBuilder table(static_cast<int>(slots));
  for (NodeIndex node = 0; node < num_nodes; ++node) {
    for (std::size_t level = 0; level < num_levels; ++level) {
      for (std::size_t slot = 0; slot < slots; ++slot) {
        const MatchLink& match = matches[(level * num_nodes + node) * slots + slot];
        table.Add(level, match.target, match.reward);
      }
    }
    table.EndNode();
  }
  return std::move(table).Take();
}

// All matches of a node, ascending by level.
inline std::vector<MatchTable::Match> MatchesOf(const MatchTable& table, NodeIndex node) {
  std::vector<MatchTable::Match> matches;
  table.ForEachOf(node, node + 1, [&](NodeIndex, const MatchTable::Match& match) { matches.push_back(match); });
  return matches;
}

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_SUPPORT_MATCH_LISTS_H_
