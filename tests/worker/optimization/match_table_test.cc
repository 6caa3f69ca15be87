#include "worker/optimization/match_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace depthfarm {
namespace {

using Match = MatchTable::Match;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(MatchTable, KeepsWhatHasARewardByNodeAndLevel) {
  MatchTable table;
  table.Add(0, 7, 5);
  table.Add(2, 8, 0);
  table.Add(3, 9, 6);
  table.Add(3, 7, 4);
  table.EndNode();
  table.EndNode();
  table.Add(1, 0, 1);
  table.EndNode();
  EXPECT_EQ(table.num_nodes(), 3U);
  EXPECT_EQ(table.size(), 4U);
  EXPECT_THAT(table.Of(0), ElementsAre(Match{7, 5, 0}, Match{9, 6, 3}, Match{7, 4, 3}));
  EXPECT_THAT(table.Of(1), IsEmpty());
  EXPECT_THAT(table.At(0, 3), ElementsAre(Match{9, 6, 3}, Match{7, 4, 3}));
  EXPECT_THAT(table.At(0, 2), IsEmpty());
  EXPECT_THAT(table.At(0, 4), IsEmpty());
  EXPECT_THAT(table.At(1, 0), IsEmpty());
  EXPECT_THAT(table.At(2, 1), ElementsAre(Match{0, 1, 1}));
}

TEST(MatchTable, APartAppendedIsTheSameAsItsNodesOneByOne) {
  const auto add = [](NodeIndex begin, NodeIndex end, MatchTable& table) {
    for (NodeIndex node = begin; node < end; ++node) {
      test::Random random(node);
      for (std::size_t level = 0; level < 5; ++level) {
        table.Add(level, node + 1, static_cast<std::uint16_t>(random.Int(0, 3)));
      }
      table.EndNode();
    }
  };
  const NodeIndex nodes = 2 * MatchTable::kChunkNodes + 10;
  MatchTable whole;
  add(0, nodes, whole);
  MatchTable parts;
  for (NodeIndex begin = 0; begin < nodes; begin += MatchTable::kChunkNodes) {
    MatchTable part;
    add(begin, std::min(begin + MatchTable::kChunkNodes, nodes), part);
    parts.Append(std::move(part));
  }
  EXPECT_EQ(parts, whole);
  EXPECT_EQ(parts.num_nodes(), nodes);
}

}  // namespace
}  // namespace depthfarm
