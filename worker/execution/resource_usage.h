#ifndef DEPTHFARM_WORKER_EXECUTION_RESOURCE_USAGE_H_
#define DEPTHFARM_WORKER_EXECUTION_RESOURCE_USAGE_H_

#include <cstdint>

namespace depthfarm {

struct ResourceUsage {
  double cpu_seconds = 0;               // user + system of the calling thread and of the loops that it spread
  std::uint64_t peak_memory_bytes = 0;  // largest resident set of the process so far
};

[[nodiscard]] ResourceUsage UsageOfThread();

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_RESOURCE_USAGE_H_
