#include "worker/segmentation/snic_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <set>
#include <utility>

namespace depthfarm {
namespace {

SnicElement PopAny(SnicQueue& queue) {
  SnicElement element;
  EXPECT_TRUE(queue.Pop([](const SnicElement&) { return true; }, element));
  return element;
}

bool Empty(SnicQueue& queue) {
  SnicElement element;
  return !queue.Pop([](const SnicElement&) { return true; }, element);
}

TEST(SnicQueue, ServesEqualDistancesInOrderOfSequence) {
  SnicQueue queue;
  for (const std::uint32_t sequence : {3U, 0U, 2U, 1U}) queue.Push({1.5, sequence, 0, 0});
  for (std::uint32_t sequence = 0; sequence < 4; ++sequence) EXPECT_EQ(PopAny(queue).sequence, sequence);
  EXPECT_TRUE(Empty(queue));
}

// Against an ordered set, with distances that fall into few and into all buckets, and beyond the first and last one.
TEST(SnicQueue, ServesTheSmallestOfAnyMixOfPushesAndPops) {
  std::mt19937 random(1);
  const auto few = [&] { return static_cast<double>(random() % 50); };
  const auto many = [&] { return std::ldexp(1000.0 + few(), static_cast<int>(random() % 50) - 30); };
  for (const std::function<double()>& distance : {std::function<double()>(few), std::function<double()>(many)}) {
    SnicQueue queue;
    std::set<std::pair<double, std::uint32_t>> expected;
    for (std::uint32_t sequence = 0; sequence < 20'000; ++sequence) {
      // grows at first, shrinks later
      if (random() % 20'000 > sequence || expected.empty()) {
        const double pushed = distance();
        queue.Push({pushed, sequence, static_cast<std::uint16_t>(sequence), 7});
        expected.insert({pushed, sequence});
      } else {
        const SnicElement element = PopAny(queue);
        ASSERT_EQ(std::pair(element.distance, element.sequence), *expected.begin());
        ASSERT_EQ(element.x, static_cast<std::uint16_t>(element.sequence));
        expected.erase(expected.begin());
      }
    }
    while (!expected.empty()) {
      ASSERT_EQ(PopAny(queue).sequence, expected.begin()->second);
      expected.erase(expected.begin());
    }
    ASSERT_TRUE(Empty(queue));
  }
}

TEST(SnicQueue, LeavesOutWhatIsNotLive) {
  SnicQueue queue;
  for (std::uint32_t sequence = 0; sequence < 1000; ++sequence) queue.Push({sequence % 37 * 3.0, sequence, 0, 0});
  const auto is_live = [](const SnicElement& element) { return element.sequence % 3 == 0; };
  SnicElement element;
  double last = 0;
  int served = 0;
  for (; queue.Pop(is_live, element); ++served) {
    EXPECT_EQ(element.sequence % 3, 0U);
    EXPECT_GE(element.distance, last);
    last = element.distance;
  }
  EXPECT_EQ(served, 334);
}

}  // namespace
}  // namespace depthfarm
