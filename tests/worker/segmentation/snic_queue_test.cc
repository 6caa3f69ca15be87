#include "worker/segmentation/snic_queue.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <set>
#include <utility>

namespace depthfarm {
namespace {

TEST(SnicQueue, ServesEqualDistancesInOrderOfSequence) {
  SnicQueue queue;
  for (const std::uint32_t sequence : {3U, 0U, 2U, 1U}) queue.Push({1.5, sequence, 0, 0});
  for (std::uint32_t sequence = 0; sequence < 4; ++sequence) EXPECT_EQ(queue.Pop().sequence, sequence);
  EXPECT_TRUE(queue.empty());
}

TEST(SnicQueue, ServesTheSmallestOfAnyMixOfPushesAndPops) {
  std::mt19937 random(1);
  SnicQueue queue;
  std::set<std::pair<double, std::uint32_t>> expected;
  for (std::uint32_t sequence = 0; sequence < 20'000; ++sequence) {
    // grows at first, shrinks later; few distinct distances, so many ties
    if (random() % 20'000 > sequence || expected.empty()) {
      const auto distance = static_cast<double>(random() % 50);
      queue.Push({distance, sequence, static_cast<std::uint16_t>(sequence), 7});
      expected.insert({distance, sequence});
    } else {
      const SnicElement element = queue.Pop();
      ASSERT_EQ(std::pair(element.distance, element.sequence), *expected.begin());
      ASSERT_EQ(element.x, static_cast<std::uint16_t>(element.sequence));
      expected.erase(expected.begin());
    }
    ASSERT_EQ(queue.empty(), expected.empty());
  }
}

}  // namespace
}  // namespace depthfarm
