#include "worker/execution/resource_usage.h"

#include <sys/resource.h>

namespace depthfarm {
namespace {

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
}

ResourceUsage UsageOf(int who) {
  rusage usage{};
  if (getrusage(who, &usage) != 0) return {};
  // The kernel reports the peak of the process even for a thread, in KiB.
  return {Seconds(usage.ru_utime) + Seconds(usage.ru_stime), static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

}  // namespace

ResourceUsage UsageOfThread() { return UsageOf(RUSAGE_THREAD); }

ResourceUsage UsageOfProcess() { return UsageOf(RUSAGE_SELF); }

}  // namespace depthfarm
