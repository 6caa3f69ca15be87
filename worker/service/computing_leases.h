#ifndef DEPTHFARM_WORKER_SERVICE_COMPUTING_LEASES_H_
#define DEPTHFARM_WORKER_SERVICE_COMPUTING_LEASES_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// What the slots of a worker compute, in memory that it shares with the process that it was forked from: so that is
// known when the worker is gone, however it went. Thread-safe.
class ComputingLeases {
 public:
  // kUnavailable: no memory.
  [[nodiscard]] static Result<std::unique_ptr<ComputingLeases>> Make(int slots);
  ~ComputingLeases();
  ComputingLeases(const ComputingLeases&) = delete;
  ComputingLeases& operator=(const ComputingLeases&) = delete;

  void Begin(int slot, LeaseId lease) { leases_[static_cast<std::size_t>(slot)] = lease.value(); }
  void End(int slot) { leases_[static_cast<std::size_t>(slot)] = 0; }
  // By slot.
  [[nodiscard]] std::vector<LeaseId> List() const;

 private:
  using Cell = std::atomic<std::uint64_t>;  // 0: nothing
  static_assert(Cell::is_always_lock_free);
  explicit ComputingLeases(std::span<Cell> leases) : leases_(leases) {}

  std::span<Cell> leases_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_COMPUTING_LEASES_H_
