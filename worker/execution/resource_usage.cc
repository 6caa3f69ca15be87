#include "worker/execution/resource_usage.h"

#include <sys/resource.h>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
}

}  // namespace

ResourceUsage UsageOfThread() {
  rusage usage{};
  if (getrusage(RUSAGE_THREAD, &usage) != 0) return {};
  // The kernel reports the peak of the process even for a thread, in KiB.
  return {Seconds(usage.ru_utime) + Seconds(usage.ru_stime) + SecondsOfHelpers(),
          static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

}  // namespace depthfarm
