#include "common/base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <thread>
#include <vector>

namespace depthfarm {
namespace {

TEST(ParallelFor, CallsEachIndexOnceOnAnyNumberOfThreads) {
  for (const int threads : {-1, 0, 1, 2, 5, 64}) {
    std::vector<std::atomic<int>> calls(37);
    ParallelFor(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1) << threads;
  }
}

TEST(ParallelFor, NothingToDo) {
  ParallelFor(0, 4, [](std::size_t) { FAIL(); });
}

TEST(ParallelFor, ThrowsWhatACallThrewAfterAllHaveEnded) {
  std::atomic<int> running = 0;
  const auto call = [&](std::size_t i) {
    ++running;
    const bool fails = i == 3;
    --running;
    if (fails) throw std::runtime_error("three");
  };
  EXPECT_THROW(ParallelFor(100, 4, call), std::runtime_error);
  EXPECT_EQ(running, 0);
}

TEST(ParallelFor, IsAPlainLoopOnOneThread) {
  std::vector<std::size_t> order;
  ParallelFor(4, 1, [&](std::size_t i) { order.push_back(i); });
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3}));
  const auto throws_at_two = [&](std::size_t i) {
    if (i == 2) throw std::runtime_error("two");
    order.push_back(i);
  };
  EXPECT_THROW(ParallelFor(4, 1, throws_at_two), std::runtime_error);
  EXPECT_EQ(order.size(), 6U);
}

TEST(ParallelForPieces, CoversAllOnceInPiecesOfOneSize) {
  for (const int threads : {1, 2, 3, 5}) {
    for (const std::size_t count : {0U, 1U, 9U, 10U, 11U, 37U}) {
      std::vector<std::atomic<int>> calls(count);
      ParallelForPieces(count, 10, threads, [&](std::size_t begin, std::size_t end) {
        EXPECT_EQ(begin % 10, 0U);
        EXPECT_EQ(end, std::min(count, begin + 10));
        for (std::size_t i = begin; i < end; ++i) ++calls[i];
      });
      for (const auto& calls_of_one : calls) EXPECT_EQ(calls_of_one, 1) << threads << " threads, " << count;
    }
  }
}

TEST(ParallelFor, CountsWhatItsHelpersSpend) {
  const double before = SecondsOfHelpers();
  ParallelFor(1, 4, [](std::size_t) {});
  EXPECT_EQ(SecondsOfHelpers(), before);
  std::atomic<std::uint64_t> sum = 0;
  std::atomic<int> waiting = 0;
  ParallelFor(2, 2, [&](std::size_t) {
    for (++waiting; waiting < 2;) std::this_thread::yield();  // both threads have a part
    for (std::uint64_t i = 0; i < 2'000'000; ++i) sum += i;
  });
  EXPECT_GT(SecondsOfHelpers(), before);
}

}  // namespace
}  // namespace depthfarm
