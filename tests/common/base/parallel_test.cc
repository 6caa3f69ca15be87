#include "common/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
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

}  // namespace
}  // namespace depthfarm
