#ifndef DEPTHFARM_WORKER_SERVICE_COMPUTE_POOL_H_
#define DEPTHFARM_WORKER_SERVICE_COMPUTE_POOL_H_

#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "common/job/task_spec.h"
#include "worker/execution/fetch_ahead.h"
#include "worker/execution/lease_term.h"
#include "worker/execution/task_executor.h"

namespace depthfarm {

// A task under a lease.
struct LeasedTask {
  LeaseId lease;
  TaskSpec spec;
  std::shared_ptr<const JobConfig> config;
  std::shared_ptr<LeaseTerm> term;
};

struct LeasedOutcome {
  LeaseId lease;
  TaskId task;
  TaskOutcome outcome;
};

// Executes leased tasks beside the thread that talks to the coordinator: as many at a time as it has slots, in the
// order in which they came. While all slots compute, one more thread fetches the inputs of those that wait.
class ComputePool {
 public:
  // Both are called in threads of the pool; Execute with the slot, 0 to slots - 1, which runs one task at a time.
  using Execute = std::function<TaskOutcome(int slot, const LeasedTask&, const std::stop_token&)>;
  // Fetch ends soon after `stop`, and after what it is at when `enough` is requested.
  using Fetch =
      std::function<FetchedAhead(const TaskSpec&, const std::stop_token& stop, const std::stop_token& enough)>;
  // `on_done` is called in some thread after each task, to say that there is an outcome to take.
  ComputePool(int slots, Execute execute, Fetch fetch, std::function<void()> on_done);
  // Stops all tasks and waits for them.
  ~ComputePool();
  ComputePool(const ComputePool&) = delete;
  ComputePool& operator=(const ComputePool&) = delete;

  // Requires that the lease is new. A task whose term is over when a slot takes it is not begun (kLeaseExpired).
  void Start(LeasedTask task);
  // Asks a task to stop; its outcome comes all the same. Nothing if there is no such task.
  void Stop(LeaseId lease);
  // Ends a task that no slot has begun, kCancelled; its outcome comes all the same. False, and nothing, for others.
  [[nodiscard]] bool GiveBack(LeaseId lease);
  // In the order in which the tasks ended.
  [[nodiscard]] std::optional<LeasedOutcome> TakeOutcome();
  // Whether a task was started whose outcome was not taken yet.
  [[nodiscard]] bool busy() const;

 private:
  enum class Stage { kWaiting, kFetching, kFetched, kComputing };
  struct Entry {
    LeasedTask task;
    std::stop_source stop;
    std::stop_source enough;  // of its inputs: a slot waits for it
    Stage stage = Stage::kWaiting;
    FetchedAhead fetched;
  };
  using Entries = std::list<Entry>;  // in the order of their start; an entry stays where it is in memory

  void Compute(int slot);
  void FetchInputs();
  // The functions below require the mutex.
  [[nodiscard]] Entries::iterator Find(LeaseId lease);
  // Ends the task, or has whoever has it in hand end it. True if its outcome is there.
  [[nodiscard]] bool StopEntry(Entries::iterator entry);
  [[nodiscard]] Entries::iterator NextToCompute();
  [[nodiscard]] Entries::iterator NextToFetch();
  void End(Entries::iterator entry, TaskOutcome outcome);
  // Of a task that did not begin.
  void EndStopped(Entries::iterator entry);

  const Execute execute_;
  const Fetch fetch_;
  const std::function<void()> on_done_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ending_ = false;
  int idle_slots_;
  Entries entries_;
  std::list<LeasedOutcome> outcomes_;
  std::vector<std::thread> threads_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_COMPUTE_POOL_H_
