#include "common/base/thread_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

using Helpers = ThreadBudget::Helpers;
using Task = ThreadBudget::Task;

TEST(ThreadBudget, GivesATaskWhatIsIdleUntilItsLoopEnds) {
  ThreadBudget budget(4);
  const Task task(budget);
  for (int i = 0; i < 2; ++i) {
    const Helpers two(2);
    EXPECT_EQ(two.count(), 2);
    const Helpers rest(5);
    EXPECT_EQ(rest.count(), 1);
    EXPECT_EQ(Helpers(1).count(), 0);
  }
}

TEST(ThreadBudget, ThreadsWithoutATaskTakeAsManyAsTheyWant) {
  const ThreadBudget budget(1);
  EXPECT_EQ(Helpers(7).count(), 7);
  EXPECT_EQ(ThreadBudget::IdleForThisThread(7), 7);
}

TEST(ThreadBudget, ATaskMoreIsAHelperLess) {
  ThreadBudget budget(2);
  const Task task(budget);
  EXPECT_EQ(ThreadBudget::IdleForThisThread(3), 1);
  std::jthread([&] {
    const Task other(budget);
    EXPECT_EQ(Helpers(1).count(), 0);
    std::jthread([&] {
      const Task one_too_many(budget);
      EXPECT_EQ(Helpers(1).count(), 0);
      EXPECT_EQ(ThreadBudget::IdleForThisThread(3), 0);
    }).join();
    EXPECT_EQ(Helpers(1).count(), 0);
  }).join();
  EXPECT_EQ(Helpers(3).count(), 1);
}

TEST(ThreadBudget, ATaskThatBeginsWhileALoopHasAllThreadsGetsNone) {
  ThreadBudget budget(2);
  const Task task(budget);
  const Helpers all(1);
  EXPECT_EQ(all.count(), 1);
  std::jthread([&] {
    const Task other(budget);
    EXPECT_EQ(Helpers(1).count(), 0);
  }).join();
}

TEST(ThreadBudget, LoopsWithinLoopsStayWithinIt) {
  constexpr int kThreads = 3;
  ThreadBudget budget(kThreads);
  const Task task(budget);
  std::atomic<int> running = 0;
  std::atomic<int> most = 0;
  std::atomic<int> calls = 0;
  ParallelFor(8, 8, [&](std::size_t) {
    ParallelFor(8, 8, [&](std::size_t) {
      const int now = ++running;
      for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
      }
      std::this_thread::yield();
      ++calls;
      --running;
    });
  });
  EXPECT_EQ(calls, 64);
  EXPECT_LE(most, kThreads);
  EXPECT_EQ(Helpers(9).count(), kThreads - 1);
}

TEST(ThreadBudget, WithoutAnIdleThreadALoopIsAPlainOne) {
  ThreadBudget budget(1);
  const Task task(budget);
  std::vector<std::size_t> order;
  ParallelFor(5, 4, [&](std::size_t i) { order.push_back(i); });
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace depthfarm
