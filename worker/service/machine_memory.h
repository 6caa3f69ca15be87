#ifndef DEPTHFARM_WORKER_SERVICE_MACHINE_MEMORY_H_
#define DEPTHFARM_WORKER_SERVICE_MACHINE_MEMORY_H_

#include <cstdint>
#include <string>

namespace depthfarm {

// Bytes that this process may use: of the machine, or less if its control group (cgroup version 2) says so; 0 when
// nobody tells. `cgroup_root` and `proc_cgroup` are for tests.
[[nodiscard]] std::uint64_t MachineMemory(const std::string& cgroup_root = "/sys/fs/cgroup",
                                          const std::string& proc_cgroup = "/proc/self/cgroup");

// What of it is for tasks, beside the `cache_bytes` of decoded artifacts that are kept between them: the rest, at least
// half of all.
[[nodiscard]] std::uint64_t TaskMemory(std::uint64_t machine_bytes, std::uint64_t cache_bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_MACHINE_MEMORY_H_
