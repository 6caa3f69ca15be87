#include "worker/artifacts/key_locks.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <stop_token>
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
        const auto lock = locks.Take(ArtifactKey{static_cast<std::uint8_t>(which)}, {});
        ASSERT_TRUE(lock.ok());
        EXPECT_EQ(++inside[which], 1);
        std::this_thread::yield();
        --inside[which];
      }
    });
  }
}

TEST(KeyLocks, WhoWaitsEndsWhenStopped) {
  for (int i = 0; i < 20; ++i) {
    KeyLocks locks;
    std::stop_source stop;
    {
      const auto held = locks.Take(ArtifactKey{1}, {});
      ASSERT_TRUE(held.ok());
      std::jthread waiting(
          [&] { EXPECT_EQ(locks.Take(ArtifactKey{1}, stop.get_token()).status().code(), ErrorCode::kCancelled); });
      if (i % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // most likely it waits by then
      stop.request_stop();
    }
    EXPECT_TRUE(locks.Take(ArtifactKey{1}, {}).ok()) << "who gave up has no lock";
  }
}

}  // namespace
}  // namespace depthfarm
