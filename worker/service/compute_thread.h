#ifndef DEPTHFARM_WORKER_SERVICE_COMPUTE_THREAD_H_
#define DEPTHFARM_WORKER_SERVICE_COMPUTE_THREAD_H_

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "common/job/task_spec.h"
#include "worker/execution/task_executor.h"

namespace depthfarm {

// A task under a lease.
struct LeasedTask {
  LeaseId lease;
  TaskSpec spec;
  std::shared_ptr<const JobConfig> config;
};

struct LeasedOutcome {
  LeaseId lease;
  TaskId task;
  TaskOutcome outcome;
};

// Executes tasks one at a time beside the thread that talks to the coordinator.
class ComputeThread {
 public:
  using Execute = std::function<TaskOutcome(const TaskSpec&, const JobConfig&, const std::stop_token&)>;
  // `execute` is called in the thread; `on_done` too, after each task, to say that there is an outcome to take.
  ComputeThread(Execute execute, std::function<void()> on_done);
  // Stops the task and waits for it.
  ~ComputeThread();
  ComputeThread(const ComputeThread&) = delete;
  ComputeThread& operator=(const ComputeThread&) = delete;

  // Requires that no task is under way and the last outcome was taken.
  void Start(LeasedTask task);
  // Asks the task under way to stop, whichever it is; its outcome comes all the same.
  void Stop();
  [[nodiscard]] std::optional<LeasedOutcome> TakeOutcome();
  // Whether a task was started whose outcome was not taken yet.
  [[nodiscard]] bool busy() const;

 private:
  void Run();

  const Execute execute_;
  const std::function<void()> on_done_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ending_ = false;
  bool busy_ = false;
  std::stop_source stop_;
  std::optional<LeasedTask> task_;        // started, not taken up by the thread yet
  std::optional<LeasedOutcome> outcome_;  // ended, not taken yet
  std::thread thread_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_COMPUTE_THREAD_H_
