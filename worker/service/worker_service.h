#ifndef DEPTHFARM_WORKER_SERVICE_WORKER_SERVICE_H_
#define DEPTHFARM_WORKER_SERVICE_WORKER_SERVICE_H_

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/machine_memory.h"
#include "common/base/status.h"
#include "common/base/thread_budget.h"
#include "common/files/file_roots.h"
#include "common/files/path_map.h"
#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/transport/farm_keys.h"
#include "common/transport/poller.h"
#include "worker/artifacts/memory_cache.h"
#include "worker/artifacts/store.h"
#include "worker/execution/task_executor.h"
#include "worker/lifecycle/lifecycle.h"
#include "worker/service/compute_pool.h"
#include "worker/service/computing_leases.h"
#include "worker/service/messages.h"
#include "worker/transfer/artifact_client.h"
#include "worker/transfer/artifact_server.h"

namespace depthfarm {

inline constexpr int kMostWorkerThreads = 256;  // that may be asked for

struct WorkerOptions {
  std::string coordinator;     // endpoint
  std::filesystem::path keys;  // folder; empty: no CURVE
  bool insecure = false;       // tcp without CURVE, on loopback addresses only
  std::filesystem::path cache_dir;
  std::uint64_t cache_bytes = std::uint64_t{8} << 30;  // bound of the store
  std::uint64_t memory_bytes = kUsualCacheBytes;       // bound of the decoded artifacts kept in memory
  int slots = 1;                                       // tasks computed at a time
  std::vector<std::string> tags;                       // what it has that jobs may ask for
  std::uint64_t task_memory_bytes = 0;                 // for its tasks; 0: TaskMemory of this machine, alone
  int ahead = 1;                                       // tasks taken besides, to fetch their inputs meanwhile
  PathMap paths;                                       // where this host has what jobs name
  FileRoots roots;                                     // of this host's folders, where jobs may read and write
  std::string name;                                    // empty: see Identify
  std::string artifact_listen;                         // empty: DefaultArtifactEndpoint
  std::string advertise;                               // host name for peers; empty: this host's name, or as bound
  int threads = 1;                                     // that its tasks share; one for each slot where that is more
  std::string software_version;
  Milliseconds stop_grace{0};                       // how long Stop lets tasks finish; a second Stop does not
  std::optional<Milliseconds> give_up;              // leave after so long without the coordinator
  std::uint64_t process = 0;                        // tells it from others of its name; 0: see Identify
  std::shared_ptr<ComputingLeases> computing = {};  // kept up to date, if there is one
};

// Gives the options a name (host:pid:random) and a process, by chance, where they have none.
void Identify(WorkerOptions& options);

// Fetches inputs from other workers. Not thread-safe: each thread that fetches has its own.
class PeerFetcher : public ArtifactFetcher {
 public:
  explicit PeerFetcher(ArtifactClient client) : client_(std::move(client)) {}
  [[nodiscard]] Result<std::string> Fetch(const TaskInput& input, const std::stop_token& stop) override {
    return client_.Fetch(input.artifact, input.locations, stop);
  }

 private:
  ArtifactClient client_;
};

// A worker: carries out what its Lifecycle decides. Threads: the caller of Run talks to the coordinator, one computes
// for each slot, one fetches inputs ahead, one serves artifacts to peers;
// whoever fetches a large artifact has another one for its digest.
class WorkerService {
 public:
  // Opens store and sockets. Errors: kInvalidArgument: endpoints, keys, security rules; kUnavailable: folder or
  // address.
  [[nodiscard]] static Result<std::unique_ptr<WorkerService>> Create(const WorkerOptions& options);
  ~WorkerService() = default;
  WorkerService(const WorkerService&) = delete;
  WorkerService& operator=(const WorkerService&) = delete;

  // Works until the coordinator or Stop ends it (ok), or it is refused or gives up (an error).
  [[nodiscard]] Status Run();
  // Asks Run to say goodbye and return, after its tasks if WorkerOptions::stop_grace lets them finish. From any thread
  // or signal handler.
  void Stop();
  // Has Run read again which keys may fetch from this worker; with an error in them the old ones stay, which the log
  // tells. From any thread or signal handler.
  void RereadKeys();
  // After Run: whether a task did not notice in time that it was stopped. The destructor would wait for it.
  [[nodiscard]] bool busy() const { return compute_->busy(); }

 private:
  explicit WorkerService(const WorkerOptions& options);
  [[nodiscard]] Status Open();
  [[nodiscard]] Status OpenArtifacts(const std::optional<WorkerKeys>& keys);

  [[nodiscard]] Status ReceiveAll();
  void OnMessage(const v1::Envelope& message);
  void OnGrant(const v1::GrantTask& grant);
  void OnOutcome(LeasedOutcome outcome);
  void RenewTerms();
  void OnStopSignal();
  void ReportDropped();
  void ReadmitPeers();
  void Handle(const LifecycleEvent& event);
  void CarryOut(const std::vector<LifecycleAction>& actions);
  void Do(const lifecycle_action::SendHello& action);
  void Do(const lifecycle_action::SendAsk& action);
  void Do(const lifecycle_action::SendHeartbeat& action);
  void Do(const lifecycle_action::StartTask& action);
  void Do(const lifecycle_action::StopTask& action);
  void Do(const lifecycle_action::ReportTask& action);
  void Do(const lifecycle_action::DropResult& action);
  void Do(const lifecycle_action::RefuseGrant& action);
  void Do(const lifecycle_action::SendGoodbye& action);
  void Do(const lifecycle_action::Exit& action);
  void Send(v1::Envelope message);
  [[nodiscard]] Milliseconds UntilNextDue() const;

  const WorkerOptions options_;
  ThreadBudget threads_;  // of what computes
  WorkerIdentity identity_;
  std::atomic<bool> stop_requested_ = false;
  std::atomic<bool> reread_ = false;
  Poller poller_;
  TransportContext context_;
  std::unique_ptr<ArtifactStore> store_;
  std::unique_ptr<ArtifactServer> server_;
  std::unique_ptr<MemoryCache> cache_;
  std::vector<std::unique_ptr<PeerFetcher>> fetchers_;    // one for each slot, and that which fetches ahead
  std::vector<std::unique_ptr<TaskExecutor>> executors_;  // one for each slot
  std::unique_ptr<ClientChannel> coordinator_;
  std::unique_ptr<Lifecycle> lifecycle_;
  std::map<JobId, std::shared_ptr<const JobConfig>> jobs_;
  std::map<LeaseId, std::shared_ptr<LeaseTerm>> terms_;  // of tasks that did not end yet
  bool keeps_freed_memory_ = false;                      // of tasks, until there is a heartbeat without any
  std::optional<LeasedTask> granted_;                    // while the lifecycle decides about it
  std::optional<LeasedOutcome> ended_;                   // same
  std::optional<Status> exit_;
  std::unique_ptr<ComputePool> compute_;  // last: ends first
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_WORKER_SERVICE_H_
