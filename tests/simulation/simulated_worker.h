#ifndef DEPTHFARM_TESTS_SIMULATION_SIMULATED_WORKER_H_
#define DEPTHFARM_TESTS_SIMULATION_SIMULATED_WORKER_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/wire/envelope.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/network.h"
#include "tests/support/random.h"
#include "worker/execution/output_folder.h"
#include "worker/lifecycle/lifecycle.h"
#include "worker/service/messages.h"

namespace depthfarm::simulation {

// Each coordinator numbers its leases from a multiple of this on.
inline constexpr std::uint64_t kLeasesOfCoordinator = std::uint64_t{1} << 24U;

struct WorkerShape {
  int slots = 1;
  int ahead = 0;
  std::size_t store_bound = 200;  // artifacts
  int task_length = 1;            // times the usual one
  std::vector<std::string> tags = {};
};

// How often tasks go wrong, in percent.
struct TaskFaults {
  int fails = 0;               // for no reason
  int disk_is_full = 0;        // what it made can't be stored
  int runs_out_of_memory = 0;  // which kills the worker
};

class SimulatedWorker;

// What a worker has around it. All outlive it.
struct Surroundings {
  EventQueue& events;
  test::Random& random;
  Network& network;
  TaskFaults& faults;
  bool tells_deaths;  // else nobody minds the workers
  // Sends to the coordinator.
  std::function<void(const std::string& host, const std::string& peer, std::string payload)> send;
  // The same, on a connection of its own: in whatever order with the others.
  std::function<void(const std::string& host, std::string payload)> send_beside;
  // The worker whose artifact server that is now; null: nobody's.
  std::function<const SimulatedWorker*(const std::string& endpoint)> find;
  // A task was begun.
  std::function<void(const SimulatedWorker& worker, LeaseId lease, const TaskSpec& spec)> begun;
  // A poisonous task killed the worker.
  std::function<void(const TaskId& task)> poisoned;
};

// A worker process: the real lifecycle, messages and output folder; computing, store and transfer are made up. It can
// end at any event, stand still for a while or be slow.
class SimulatedWorker {
 public:
  SimulatedWorker(std::string name, WorkerShape shape, Surroundings& around);

  // Starts the process; with the store that its last life left.
  void Start();
  void Crash();
  // The same; sometimes whoever minds the process is left and tells of it.
  void Die();
  // As SIGSTOP, for so long.
  void Hang(Milliseconds time);
  void SetSlowness(int factor) { slowness_ = factor; }
  // As SIGTERM.
  void Stop();
  // Its connection to the coordinator is made anew.
  void Reconnect();
  // A message from the network; none of a connection that is not its own any more.
  void Receive(const std::string& peer, const std::string& payload);
  void ForgetStore() { store_.clear(); }
  // What it holds is not what it was, which its reader finds out.
  void DamageArtifacts(int percent);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& peer() const { return peer_; }
  [[nodiscard]] bool alive() const { return lifecycle_ != nullptr; }
  [[nodiscard]] int life() const { return life_; }  // grows with each end and start of the process
  [[nodiscard]] bool hung() const { return hung_until_.has_value(); }
  // The lease, other than this one and of the coordinator that granted it, under which it believes to have the task.
  [[nodiscard]] std::optional<LeaseId> BelievesIn(const TaskId& task, LeaseId lease) const;
  // A task of the job that it believes to have from the coordinator that granted the lease, other than that lease's.
  [[nodiscard]] std::optional<TaskId> WorksFor(JobId job, LeaseId lease) const;
  // What its artifact server sends; nothing when it can't.
  [[nodiscard]] std::optional<ContentDigest> Serve(const ArtifactKey& key) const;
  [[nodiscard]] std::string endpoint() const;
  [[nodiscard]] std::uint64_t tasks_begun() const { return tasks_begun_; }
  [[nodiscard]] std::uint64_t tasks_given_back() const { return tasks_given_back_; }  // as they were asked for
  [[nodiscard]] std::uint64_t deaths_told() const { return deaths_told_; }

 private:
  struct Stored {
    ArtifactInfo info;
    ContentDigest content{};  // what is there in fact
    bool released = false;
    bool kept = false;
    std::uint64_t used = 0;
  };
  struct Running {
    LeaseId lease;
    TaskSpec spec;
    std::shared_ptr<const JobConfig> config;
    bool computing = false;
    TimePoint begun = {};
    bool stopping = false;
  };
  using Tasks = std::list<Running>;

  enum class Thread { kNetwork, kCompute };
  // Lets something happen in this life of the process, when it does not stand still.
  void After(Milliseconds pause, Thread thread, EventQueue::Action action);
  void Do(Thread thread, const EventQueue::Action& action);
  void Run(const EventQueue::Action& action);
  void WakeUp();
  [[nodiscard]] Milliseconds Slowly(int from, int to);

  void OnMessage(const v1::Envelope& message);
  void OnGrant(const v1::GrantTask& grant);
  void Handle(const LifecycleEvent& event);
  void CarryOut(const std::vector<LifecycleAction>& actions);
  void Carry(const LifecycleAction& action);
  void PlanTick();
  void Send(v1::Envelope message);

  void BeginTasks();
  void FetchInputs(LeaseId lease);
  void Compute(LeaseId lease);
  void FinishTask(LeaseId lease);
  [[nodiscard]] TaskOutcome Execute(const Running& task);
  [[nodiscard]] Result<OutputFolder> FolderOf(const Running& task) const;
  [[nodiscard]] Status WorkInFolder(const Running& task, TaskOutcome& outcome) const;
  [[nodiscard]] Status StageFiles(const Running& task, std::size_t count) const;
  void EndTask(LeaseId lease, TaskOutcome outcome);
  void StopTask(LeaseId lease);
  [[nodiscard]] bool Fetch(const TaskInput& input);
  // Nothing when the store does not have it, or has something else.
  [[nodiscard]] const Stored* Read(const ArtifactKey& key);
  void Store(const ArtifactInfo& artifact);
  void Evict();
  [[nodiscard]] Tasks::iterator Find(LeaseId lease);

  const std::string name_;
  const WorkerShape shape_;
  Surroundings& around_;
  int life_ = 0;
  int connection_ = 0;
  int slowness_ = 1;
  std::string peer_;
  std::unique_ptr<Lifecycle> lifecycle_;
  TimePoint tick_planned_;
  std::optional<TimePoint> hung_until_;
  std::map<Thread, std::vector<EventQueue::Action>> waiting_;  // for the end of a standstill
  bool exited_ = false;
  std::map<JobId, std::shared_ptr<const JobConfig>> jobs_;
  Tasks tasks_;
  std::optional<Running> granted_;  // while the lifecycle decides about it
  std::optional<LeasedOutcome> ended_;
  std::map<ArtifactKey, Stored> store_;
  std::vector<ArtifactKey> dropped_;
  std::uint64_t used_ = 0;
  std::uint64_t tasks_begun_ = 0;
  std::uint64_t tasks_given_back_ = 0;
  std::uint64_t deaths_told_ = 0;
};

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_SIMULATED_WORKER_H_
