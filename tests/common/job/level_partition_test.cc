#include "common/job/level_partition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace depthfarm {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Split {
  int num_levels;
  int num_blocks;
};

std::vector<Split> ManySplits() {
  std::vector<Split> splits = {{250, 1}, {250, 7}, {250, 8}, {250, 249}, {250, 250}, {65534, 4096}, {65534, 65534}};
  for (int num_levels = 2; num_levels <= 40; ++num_levels) {
    for (int num_blocks = 1; num_blocks <= num_levels; ++num_blocks) splits.push_back({num_levels, num_blocks});
  }
  return splits;
}

TEST(LevelsOfBlock, CoverEveryLevelOnceInBlocksOfNearlyOneSize) {
  for (const Partition partition : {Partition::kContiguous, Partition::kInterleaved}) {
    for (const auto [num_levels, num_blocks] : ManySplits()) {
      SCOPED_TRACE(std::to_string(num_levels) + " levels, " + std::to_string(num_blocks) + " blocks");
      std::vector<int> times(static_cast<std::size_t>(num_levels), 0);
      std::size_t smallest = times.size();
      std::size_t largest = 0;
      for (int block = 0; block < num_blocks; ++block) {
        const std::vector<Level> levels = LevelsOfBlock(num_levels, num_blocks, partition, block);
        ASSERT_TRUE(std::is_sorted(levels.begin(), levels.end()));
        for (const Level level : levels) ++times.at(level);
        smallest = std::min(smallest, levels.size());
        largest = std::max(largest, levels.size());
      }
      ASSERT_EQ(std::count(times.begin(), times.end(), 1), num_levels);
      ASSERT_GE(smallest, 1u);
      ASSERT_LE(largest - smallest, 1u);
    }
  }
}

TEST(LevelsOfBlock, ContiguousBlocksAreRangesOneAfterTheOther) {  // Fig. 2a
  for (const auto [num_levels, num_blocks] : ManySplits()) {
    int next = 0;
    for (int block = 0; block < num_blocks; ++block) {
      for (const Level level : LevelsOfBlock(num_levels, num_blocks, Partition::kContiguous, block)) {
        ASSERT_EQ(level, next++);
      }
    }
  }
}

TEST(LevelsOfBlock, InterleavedBlocksTakeEveryNthLevel) {  // Fig. 2b
  EXPECT_THAT(LevelsOfBlock(8, 3, Partition::kInterleaved, 0), ElementsAre(0, 3, 6));
  EXPECT_THAT(LevelsOfBlock(8, 3, Partition::kInterleaved, 1), ElementsAre(1, 4, 7));
  EXPECT_THAT(LevelsOfBlock(8, 3, Partition::kInterleaved, 2), ElementsAre(2, 5));
}

TEST(MergeRounds, FiveBlocksNeedThreeRounds) {  // ceil(log2 5), IV-A
  EXPECT_THAT(MergeRounds(5),
              ElementsAre(ElementsAre(MergePair{0, 1}, MergePair{2, 3}, MergePair{4, -1}),
                          ElementsAre(MergePair{0, 1}, MergePair{2, -1}), ElementsAre(MergePair{0, 1})));
}

TEST(MergeRounds, OneBlockNeedsNone) { EXPECT_THAT(MergeRounds(1), IsEmpty()); }

int CeilLog2(int n) {
  int rounds = 0;
  while ((1 << rounds) < n) ++rounds;
  return rounds;
}

TEST(MergeRounds, AreTheLogarithmAndTouchEachPartialResultOnce) {
  for (int num_blocks = 1; num_blocks <= 600; ++num_blocks) {
    SCOPED_TRACE(num_blocks);
    const std::vector<std::vector<MergePair>> rounds = MergeRounds(num_blocks);
    ASSERT_EQ(static_cast<int>(rounds.size()), CeilLog2(num_blocks));
    int partial_results = num_blocks;
    for (const std::vector<MergePair>& round : rounds) {
      std::multiset<int> touched;
      for (const MergePair& pair : round) {
        touched.insert(pair.first);
        if (pair.second != -1) touched.insert(pair.second);
      }
      ASSERT_EQ(static_cast<int>(touched.size()), partial_results);
      int next = 0;
      for (const int index : touched) ASSERT_EQ(index, next++);
      partial_results = static_cast<int>(round.size());
    }
    ASSERT_EQ(partial_results, 1);
  }
}

TEST(MergeRounds, JoinRangesOfLevelsThatTouch) {
  for (int num_blocks = 1; num_blocks <= 60; ++num_blocks) {
    struct Range {
      int begin;
      int end;
    };
    std::vector<Range> ranges;
    for (int block = 0; block < num_blocks; ++block) {
      const std::vector<Level> levels = LevelsOfBlock(61, num_blocks, Partition::kContiguous, block);
      ranges.push_back({levels.front(), levels.back() + 1});
    }
    for (const std::vector<MergePair>& round : MergeRounds(num_blocks)) {
      std::vector<Range> merged;
      for (const MergePair& pair : round) {
        Range range = ranges.at(static_cast<std::size_t>(pair.first));
        if (pair.second != -1) {
          const Range second = ranges.at(static_cast<std::size_t>(pair.second));
          ASSERT_EQ(range.end, second.begin);
          range.end = second.end;
        }
        merged.push_back(range);
      }
      ranges = merged;
    }
    ASSERT_EQ(ranges.size(), 1u);
    EXPECT_EQ(ranges[0].begin, 0);
    EXPECT_EQ(ranges[0].end, 61);
  }
}

}  // namespace
}  // namespace depthfarm
