#include "common/base/freed_memory.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <vector>

namespace depthfarm {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20U;
constexpr std::size_t kBlocks = 64;

// The resident pages of this process.
std::int64_t ResidentPages() {
  std::ifstream file("/proc/self/statm");
  std::int64_t size = 0;
  std::int64_t resident = -1;
  file >> size >> resident;
  return resident;
}

void UseAndFree() {
  std::vector<std::vector<char>> blocks;
  for (std::size_t i = 0; i < kBlocks; ++i) blocks.emplace_back(kBlock, 'x');
}

TEST(FreedMemory, IsKeptUntilItIsReturned) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer has an allocator of its own";
#endif
  KeepFreedMemory({.most_bytes = 256U << 20U, .largest_block_bytes = 32U << 20U});
  constexpr std::int64_t kHalf = kBlocks * kBlock / 4096 / 2;
  const std::int64_t before = ResidentPages();
  UseAndFree();
  EXPECT_GT(ResidentPages() - before, kHalf);
  ReturnFreedMemory();
  EXPECT_LT(ResidentPages() - before, kHalf);
}

}  // namespace
}  // namespace depthfarm
