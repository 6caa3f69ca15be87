#ifndef DEPTHFARM_COMMON_BASE_BOOT_TIME_H_
#define DEPTHFARM_COMMON_BASE_BOOT_TIME_H_

#include <chrono>

namespace depthfarm {

// A clock that is never set and goes on while the machine is suspended, which steady_clock does not; its points are of
// steady_clock's type and are compared with each other alone. A virtual machine that is paused without knowing of it
// loses that time all the same.
[[nodiscard]] std::chrono::steady_clock::time_point BootTime();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_BOOT_TIME_H_
