#include "worker/service/key_locks.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

namespace depthfarm {
namespace {

TEST(KeyLocks, OneAtATimeHasTheLockOfAKey) {
  KeyLocks locks;
  std::array<std::atomic<int>, 2> inside{};
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      const auto which = static_cast<std::size_t>(thread % 2);
      for (int i = 0; i < 200; ++i) {
        const KeyLocks::Lock lock = locks.Take(ArtifactKey{static_cast<std::uint8_t>(which)});
        EXPECT_EQ(++inside[which], 1);
        std::this_thread::yield();
        --inside[which];
      }
    });
  }
}

}  // namespace
}  // namespace depthfarm
