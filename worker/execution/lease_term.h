#ifndef DEPTHFARM_WORKER_EXECUTION_LEASE_TERM_H_
#define DEPTHFARM_WORKER_EXECUTION_LEASE_TERM_H_

#include <atomic>
#include <chrono>
#include <functional>

#include "common/base/boot_time.h"

namespace depthfarm {

// Whether a task is still its worker's to do; always when empty. A process that stood still (SIGSTOP, a suspended
// machine) goes on in the middle of a task that is somebody else's by now: whoever is about to change what others see
// asks just before.
using StillLeased = std::function<bool()>;

// Until when a task is its worker's to do: set by the thread that talks to the coordinator, read by those that compute.
class LeaseTerm {
 public:
  using Time = std::chrono::steady_clock::time_point;  // of BootTime

  explicit LeaseTerm(Time end) : end_(end.time_since_epoch().count()) {}
  void Set(Time end) { end_.store(end.time_since_epoch().count()); }
  [[nodiscard]] bool over() const { return BootTime().time_since_epoch().count() >= end_.load(); }

 private:
  std::atomic<Time::rep> end_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_LEASE_TERM_H_
