#ifndef DEPTHFARM_COMMON_BASE_MACHINE_MEMORY_H_
#define DEPTHFARM_COMMON_BASE_MACHINE_MEMORY_H_

#include <cstdint>
#include <string>

namespace depthfarm {

// Bytes that this process may use: of the machine, or less if its control group (cgroup version 2) says so; 0 when
// nobody tells. `cgroup_root` and `proc_cgroup` are for tests.
[[nodiscard]] std::uint64_t MachineMemory(const std::string& cgroup_root = "/sys/fs/cgroup",
                                          const std::string& proc_cgroup = "/proc/self/cgroup");

// Of decoded artifacts that a worker keeps between its tasks, unless it is told otherwise.
inline constexpr std::uint64_t kUsualCacheBytes = std::uint64_t{2} << 30;

// What of a machine's memory is for the tasks of one of `workers` (at least 1) workers that share it: of its share what
// is left beside the `cache_bytes` of decoded artifacts that it keeps, at least half. 0 when nobody knows the
// machine's.
[[nodiscard]] std::uint64_t TaskMemory(std::uint64_t machine_bytes, std::uint64_t cache_bytes, int workers = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_MACHINE_MEMORY_H_
