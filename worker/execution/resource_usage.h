#ifndef DEPTHFARM_WORKER_EXECUTION_RESOURCE_USAGE_H_
#define DEPTHFARM_WORKER_EXECUTION_RESOURCE_USAGE_H_

#include <cstdint>

namespace depthfarm {

struct ResourceUsage {
  double cpu_seconds = 0;               // user + system
  std::uint64_t peak_memory_bytes = 0;  // largest resident set of the process so far
};

[[nodiscard]] ResourceUsage UsageOfThread();
// Of all threads of the process.
[[nodiscard]] ResourceUsage UsageOfProcess();

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_RESOURCE_USAGE_H_
