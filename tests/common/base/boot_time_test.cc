#include "common/base/boot_time.h"

#include <gtest/gtest.h>

#include <ctime>

namespace depthfarm {
namespace {

TEST(BootTime, CountsTheTimeInWhichTheMachineWasSuspended) {
  const auto boot = [] {
    timespec now{};
    EXPECT_EQ(clock_gettime(CLOCK_BOOTTIME, &now), 0);
    return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
  };
  const auto before = boot();
  const auto since_boot = BootTime().time_since_epoch();
  EXPECT_GE(since_boot, before);
  EXPECT_LE(since_boot, boot());
}

}  // namespace
}  // namespace depthfarm
