#include "coordinator/library/in_process_farm.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/thread_budget.h"
#include "coordinator/scheduling/scheduler.h"
#include "worker/artifacts/memory_cache.h"
#include "worker/artifacts/store.h"
#include "worker/execution/task_executor.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kInterval{100};
const WorkerId kWorker{1};

// There is nobody to fetch from: what the store has lost is made again.
class NoPeers : public ArtifactFetcher {
 public:
  [[nodiscard]] Result<std::string> Fetch(const TaskInput& /*input*/, const std::stop_token& /*stop*/) override {
    return Unavailable("the artifact is not in the store any more");
  }
};

struct Ended {
  LeaseId lease;
  TaskId task;
  TaskOutcome outcome;
};

// Threads that compute tasks, one each; a task takes those that have none.
class Slots {
 public:
  Slots(ArtifactStore& store, MemoryCache& cache, const JobConfig& config, int count)
      : config_(config), budget_(count) {
    for (int i = 0; i < count; ++i) {
      executors_.push_back(std::make_unique<TaskExecutor>(store, cache, no_peers_, count));
      threads_.emplace_back(
          [this, executor = executors_.back().get()](const std::stop_token& stop) { Work(*executor, stop); });
    }
  }
  Slots(const Slots&) = delete;
  Slots& operator=(const Slots&) = delete;
  ~Slots() {
    for (std::jthread& thread : threads_) thread.request_stop();
    {
      const std::lock_guard lock(mutex_);
      for (auto& [lease, stop] : stops_) stop.request_stop();
    }
    changed_.notify_all();
  }

  void Start(LeaseId lease, TaskSpec spec) {
    const std::lock_guard lock(mutex_);
    stops_[lease];
    waiting_.push_back({lease, std::move(spec)});
    changed_.notify_all();
  }
  void Stop(LeaseId lease) {
    const std::lock_guard lock(mutex_);
    if (const auto stop = stops_.find(lease); stop != stops_.end()) stop->second.request_stop();
  }
  // A task that ended, if one does within `limit`.
  std::optional<Ended> Wait(milliseconds limit) {
    std::unique_lock lock(mutex_);
    ended_some_.wait_for(lock, limit, [this] { return !ended_.empty(); });
    if (ended_.empty()) return std::nullopt;
    Ended ended = std::move(ended_.front());
    ended_.pop_front();
    return ended;
  }
  [[nodiscard]] std::vector<LeaseId> Running() const {
    const std::lock_guard lock(mutex_);
    std::vector<LeaseId> leases;
    for (const auto& [lease, stop] : stops_) leases.push_back(lease);
    return leases;
  }

 private:
  struct Waiting {
    LeaseId lease;
    TaskSpec spec;
  };

  void Work(TaskExecutor& executor, const std::stop_token& stop) {
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stop.stop_requested() || !waiting_.empty(); });
      if (stop.stop_requested()) return;
      Waiting task = std::move(waiting_.front());
      waiting_.pop_front();
      const std::stop_token stop_task = stops_.at(task.lease).get_token();
      lock.unlock();
      TaskOutcome outcome = Compute(executor, task.spec, stop_task);
      lock.lock();
      stops_.erase(task.lease);
      ended_.push_back({task.lease, task.spec.id, std::move(outcome)});
      ended_some_.notify_all();
    }
  }

  TaskOutcome Compute(TaskExecutor& executor, const TaskSpec& spec, const std::stop_token& stop) {
    const ThreadBudget::Task of_budget(budget_);
    return executor.Execute(spec, config_, stop);
  }

  const JobConfig& config_;
  ThreadBudget budget_;
  NoPeers no_peers_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::condition_variable ended_some_;
  std::deque<Waiting> waiting_;                // guarded by mutex_, as all below
  std::map<LeaseId, std::stop_source> stops_;  // of tasks that did not end
  std::deque<Ended> ended_;
  std::vector<std::unique_ptr<TaskExecutor>> executors_;
  std::vector<std::jthread> threads_;  // last: ends first
};

// The scheduler, told what its one worker does.
class Farm {
 public:
  Farm(const PlannedJob& job, const InProcessOptions& options, ArtifactStore& store, MemoryCache& cache)
      : job_(job), options_(options), store_(store), slots_(store, cache, job_.config, options.slots), scheduler_({}) {}

  JobSnapshot Run() {
    Tell(JobSubmitted{job_, job_.config.sequence_name});
    AskWhetherToGoOn();  // before anything is computed: however short the job, one that is not wanted is cancelled
    Tell(WorkerJoined{.worker = kWorker, .name = "here", .slots = options_.slots});
    Ask();
    auto told = SteadyClock::now();
    while (!result_) {
      if (std::optional<Ended> ended = slots_.Wait(kInterval)) Report(std::move(*ended));
      const auto now = SteadyClock::now();
      if (now - told < kInterval) continue;
      told = now;
      // Leases of a worker that is heard of go on.
      Tell(WorkerHeard{kWorker, ++heartbeats_, slots_.Running()});
      Carry(scheduler_.Tick(now));
      AskWhetherToGoOn();
    }
    if (result_->state == JobState::kDone && options_.go_on) options_.go_on(*result_);
    return std::move(*result_);
  }

 private:
  void Tell(const Event& event) { Carry(scheduler_.Handle(event, SteadyClock::now())); }

  void AskWhetherToGoOn() {
    const std::optional<JobSnapshot> job = scheduler_.Job(job_.config.job);
    if (result_ || cancelled_ || !options_.go_on || !job || options_.go_on(*job)) return;
    cancelled_ = true;
    Tell(JobCancelled{job_.config.job});
  }

  // The newest ask may be answered by one task.
  void Ask() {
    std::vector<LeaseId> running = slots_.Running();
    if (static_cast<int>(running.size()) < options_.slots) Tell(WorkerAsked{kWorker, ++asks_, std::move(running)});
  }

  void Report(Ended ended) {
    TaskOutcome& outcome = ended.outcome;
    // The store's bound may have pushed something out meanwhile.
    if (const std::vector<ArtifactKey> dropped = store_.TakeDropped(); !dropped.empty()) {
      Tell(ArtifactsDropped{kWorker, dropped});
    }
    if (outcome.status.ok()) {
      Tell(TaskFinished{kWorker, ended.lease, ended.task, outcome.artifact, outcome.files, outcome.picture_digest,
                        outcome.stats});
    } else {
      Tell(TaskFailed{kWorker, ended.lease, ended.task, outcome.status, outcome.missing_inputs});
    }
    Ask();
  }

  void Carry(const std::vector<Action>& actions) {
    bool granted = false;
    for (const Action& action : actions) {
      if (const auto* grant = std::get_if<Grant>(&action)) {
        slots_.Start(grant->lease, grant->task.spec);
        granted = true;
      } else if (const auto* revoke = std::get_if<Revoke>(&action)) {
        slots_.Stop(revoke->lease);
      } else if (const auto* release = std::get_if<Release>(&action)) {
        store_.Release(release->keys);
      } else if (const auto* ended = std::get_if<JobEnded>(&action)) {
        result_ = ended->job;
      }
    }
    if (granted) Ask();
  }

  const PlannedJob& job_;
  const InProcessOptions& options_;
  ArtifactStore& store_;
  Slots slots_;
  Scheduler scheduler_;
  std::uint64_t asks_ = 0;
  std::uint64_t heartbeats_ = 0;
  bool cancelled_ = false;
  std::optional<JobSnapshot> result_;
};

}  // namespace

Result<JobSnapshot> RunInProcess(const PlannedJob& job, const InProcessOptions& options) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<ArtifactStore> store,
                             ArtifactStore::Open(options.store, options.store_bytes));
  MemoryCache cache(options.memory_bytes);
  Farm farm(job, options, *store, cache);
  return farm.Run();
}

}  // namespace depthfarm
