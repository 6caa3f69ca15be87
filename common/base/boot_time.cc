#include "common/base/boot_time.h"

#include <ctime>

namespace depthfarm {

std::chrono::steady_clock::time_point BootTime() {
  timespec now{};
  (void)clock_gettime(CLOCK_BOOTTIME, &now);  // cannot fail: every Linux since 2.6.39 has it
  const auto since_boot = std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
  return std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(since_boot));
}

}  // namespace depthfarm
