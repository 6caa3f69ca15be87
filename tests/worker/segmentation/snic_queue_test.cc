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

// Elements are told apart by their number, which is split into x and y.
void Push(SnicQueue& queue, double distance, int number) { queue.Push(distance, number % 1000, number / 1000); }
int NumberOf(const SnicElement& element) { return element.y * 1000 + element.x; }

SnicElement PopAny(SnicQueue& queue) {
  SnicElement element;
  EXPECT_TRUE(queue.Pop([](const SnicElement&) { return true; }, element));
  return element;
}

bool Empty(SnicQueue& queue) {
  SnicElement element;
  return !queue.Pop([](const SnicElement&) { return true; }, element);
}

TEST(SnicQueue, ServesEqualDistancesInOrderOfPushing) {
  SnicQueue queue;
  for (int number = 0; number < 4; ++number) Push(queue, 1.5, number);
  EXPECT_EQ(NumberOf(PopAny(queue)), 0);
  Push(queue, 1.5, 4);  // beside those that are sorted by now
  for (int number = 1; number < 5; ++number) EXPECT_EQ(NumberOf(PopAny(queue)), number);
  EXPECT_TRUE(Empty(queue));
}

// Against an ordered set, with distances that fall into few buckets, into all, beyond the first and last one, and that
// differ in their last bits alone.
TEST(SnicQueue, ServesTheSmallestOfAnyMixOfPushesAndPops) {
  std::mt19937 random(1);
  const auto few = [&] { return static_cast<double>(random() % 50); };
  const auto many = [&] { return std::ldexp(1000.0 + few(), static_cast<int>(random() % 50) - 30); };
  const auto alike = [&] { return 3.0 + std::ldexp(few(), -50); };
  for (const std::function<double()>& distance :
       {std::function<double()>(few), std::function<double()>(many), std::function<double()>(alike)}) {
    SnicQueue queue;
    std::set<std::pair<double, int>> expected;
    for (int number = 0; number < 20'000; ++number) {
      // grows at first, shrinks later
      if (static_cast<int>(random() % 20'000) > number || expected.empty()) {
        const double pushed = distance();
        Push(queue, pushed, number);
        expected.insert({pushed, number});
      } else {
        const SnicElement element = PopAny(queue);
        ASSERT_EQ(std::pair(element.distance, NumberOf(element)), *expected.begin());
        expected.erase(expected.begin());
      }
    }
    while (!expected.empty()) {
      ASSERT_EQ(NumberOf(PopAny(queue)), expected.begin()->second);
      expected.erase(expected.begin());
    }
    ASSERT_TRUE(Empty(queue));
  }
}

TEST(SnicQueue, ServesAllThatIsLiveAndDropsOnlyWhatIsNot) {
  SnicQueue queue;
  for (int number = 0; number < 1000; ++number) Push(queue, number % 37 * 3.0, number);
  const auto is_live = [](const SnicElement& element) { return NumberOf(element) % 3 == 0; };
  SnicElement element;
  double last = 0;
  int live = 0;
  int served = 0;
  for (; queue.Pop(is_live, element); ++served) {
    live += is_live(element) ? 1 : 0;
    EXPECT_GE(element.distance, last);
    last = element.distance;
  }
  EXPECT_EQ(live, 334);
  EXPECT_LT(served, 400);  // the 28 of distance 0 are never sorted, hence not dropped
}

TEST(SnicQueue, TellsWhatIsServedNext) {
  SnicQueue queue;
  for (int number = 0; number < 100; ++number) Push(queue, 200.0 + number % 3 * 0.25, number);
  EXPECT_EQ(queue.Upcoming(0), nullptr);  // nothing is sorted yet
  PopAny(queue);
  const SnicElement* upcoming = queue.Upcoming(1);
  ASSERT_NE(upcoming, nullptr);
  const int number = NumberOf(*upcoming);
  PopAny(queue);
  EXPECT_EQ(NumberOf(PopAny(queue)), number);
  EXPECT_EQ(queue.Upcoming(97), nullptr);
}

}  // namespace
}  // namespace depthfarm
