#include "worker/optimization/match_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/match_lists.h"
#include "tests/support/random.h"

namespace depthfarm {
namespace {

using Match = MatchTable::Match;
using test::MatchesOf;
using test::Random;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;

TEST(MatchTable, KeepsWhatHasARewardByNodeAndLevel) {
  MatchTableBuilder builder(2);
  builder.Add(0, 7, 5);
  builder.Add(2, 8, 0);
  builder.Add(3, 9, 6);
  builder.Add(3, 7, 4);
  builder.EndNode();
  builder.EndNode();
  builder.Add(1, 0, 1);
  builder.EndNode();
  const MatchTable table = std::move(builder).Take();
  EXPECT_EQ(table.num_nodes(), 3U);
  EXPECT_EQ(table.size(), 4U);
  EXPECT_THAT(MatchesOf(table, 0), ElementsAre(Match{7, 5, 0}, Match{9, 6, 3}, Match{7, 4, 3}));
  EXPECT_THAT(MatchesOf(table, 1), IsEmpty());
  EXPECT_THAT(table.At(0, 3), ElementsAre(Match{9, 6, 3}, Match{7, 4, 3}));
  EXPECT_THAT(table.At(0, 2), IsEmpty());
  EXPECT_THAT(table.At(0, 4), IsEmpty());
  EXPECT_THAT(table.At(1, 0), IsEmpty());
  EXPECT_THAT(table.At(2, 1), ElementsAre(Match{0, 1, 1}));
}

TEST(MatchTable, WithoutNodesOrMatchesHasNone) {
  EXPECT_EQ(MatchTableBuilder(1).Take().num_nodes(), 0U);
  MatchTableBuilder builder(3);
  for (NodeIndex node = 0; node < MatchTable::kChunkNodes + 1; ++node) builder.EndNode();
  const MatchTable table = std::move(builder).Take();
  EXPECT_EQ(table.num_nodes(), MatchTable::kChunkNodes + 1);
  EXPECT_EQ(table.size(), 0U);
  EXPECT_THAT(table.At(MatchTable::kChunkNodes, 0), IsEmpty());
  EXPECT_THAT(MatchesOf(table, 5), IsEmpty());
}

// What is added to each node of a random table: of some nodes nothing, of others up to `most` on each of some levels.
std::vector<std::vector<Match>> RandomLists(Random& random, NodeIndex nodes, int most) {
  std::vector<std::vector<Match>> lists(nodes);
  for (std::vector<Match>& list : lists) {
    const int first = random.Int(0, 200);
    for (int level = first; level < first + random.Int(0, 20); ++level) {
      if (random.Chance(50)) continue;
      for (int slot = random.Int(0, most); slot > 0; --slot) {
        list.push_back({static_cast<NodeIndex>(random.Int(0, 1 << 20)), static_cast<std::uint16_t>(random.Int(1, 6885)),
                        static_cast<std::uint16_t>(level)});
      }
    }
  }
  return lists;
}

MatchTable TableOf(const std::vector<std::vector<Match>>& lists, std::size_t begin, std::size_t end, int most) {
  MatchTableBuilder builder(most);
  for (std::size_t node = begin; node < end; ++node) {
    for (const Match& match : lists[node]) builder.Add(match.level, match.target, match.reward);
    builder.EndNode();
  }
  return std::move(builder).Take();
}

TEST(MatchTable, GivesBackWhatWasAddedInItsOrder) {
  for (const int most : {1, 2, 3, 4, 5, MatchTable::kMostPerLevel}) {
    SCOPED_TRACE(most);
    Random random(static_cast<std::uint64_t>(most));
    const NodeIndex nodes = MatchTable::kChunkNodes + 100;
    const std::vector<std::vector<Match>> lists = RandomLists(random, nodes, most);
    const MatchTable table = TableOf(lists, 0, nodes, most);
    std::size_t size = 0;
    for (NodeIndex node = 0; node < nodes; ++node) {
      size += lists[node].size();
      ASSERT_THAT(MatchesOf(table, node), ElementsAreArray(lists[node]));
      for (std::size_t level = node % 7; level < 230; level += 7) {
        std::vector<Match> expected;
        for (const Match& match : lists[node])
          if (match.level == level) expected.push_back(match);
        ASSERT_THAT(table.At(node, level), ElementsAreArray(expected)) << node << " " << level;
      }
    }
    EXPECT_EQ(table.size(), size);
  }
}

TEST(MatchTable, VisitsEachMatchOfARangeOnce) {
  Random random(1);
  constexpr NodeIndex chunk = MatchTable::kChunkNodes;
  const NodeIndex nodes = 3 * chunk - 7;
  const std::vector<std::vector<Match>> lists = RandomLists(random, nodes, 3);
  const MatchTable table = TableOf(lists, 0, nodes, 3);
  for (const auto& [begin, end] : std::vector<std::pair<NodeIndex, NodeIndex>>{{0, nodes},
                                                                               {0, 0},
                                                                               {13, 14},
                                                                               {15, 18},
                                                                               {1000, 2100},
                                                                               {chunk - 1, 2 * chunk + 5},
                                                                               {chunk, 2 * chunk},
                                                                               {2 * chunk - 1, nodes}}) {
    std::vector<std::vector<Match>> visited(nodes);
    table.ForEachOf(begin, end, [&](NodeIndex node, const Match& match) { visited[node].push_back(match); });
    for (NodeIndex node = 0; node < nodes; ++node) {
      const bool in_range = node >= begin && node < end;
      ASSERT_THAT(visited[node], ElementsAreArray(in_range ? lists[node] : std::vector<Match>())) << node;
    }
  }
}

TEST(MatchTable, APartAppendedIsTheSameAsItsNodesOneByOne) {
  Random random(2);
  const NodeIndex nodes = 2 * MatchTable::kChunkNodes + 10;
  const std::vector<std::vector<Match>> lists = RandomLists(random, nodes, 2);
  MatchTable parts;
  for (NodeIndex begin = 0; begin < nodes; begin += MatchTable::kChunkNodes)
    parts.Append(TableOf(lists, begin, std::min(begin + MatchTable::kChunkNodes, nodes), 2));
  EXPECT_EQ(parts, TableOf(lists, 0, nodes, 2));
  EXPECT_EQ(parts.num_nodes(), nodes);
}

}  // namespace
}  // namespace depthfarm
