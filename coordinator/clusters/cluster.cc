#include "coordinator/clusters/cluster.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include "common/base/host_name.h"
#include "common/base/machine_memory.h"
#include "common/files/atomic_file.h"
#include "common/text/utc_time.h"
#include "common/transport/farm_keys.h"
#include "coordinator/engines/process_engine.h"
#include "coordinator/engines/slurm_engine.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kLookInterval{2000};
constexpr milliseconds kAnswerLimit{10'000};
constexpr milliseconds kStartLimit{20'000};   // of a coordinator: a large journal takes its time
constexpr milliseconds kLeaveLimit{15'000};   // of workers that were told to end
constexpr milliseconds kCancelLimit{15'000};  // of pilots that were cancelled
constexpr milliseconds kStopGrace{10'000};    // of the coordinator
constexpr int kMostRestarts = 5;
constexpr std::size_t kTailBytes = 2000;
constexpr std::uint64_t kMostLogBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMostHostsBytes = std::uint64_t{1} << 20;

// A name that no other cluster has, here or elsewhere.
std::string NewInstance(const std::string& cluster) {
  std::random_device device;
  std::array<char, 16> digits = {};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), device(), 36).ptr;
  return cluster + "-" + std::string(digits.data(), end);
}

std::string TailFrom(const fs::path& file, std::uint64_t begin) {
  const Result<std::string> text = ReadFileBytes(file.string(), kMostLogBytes);
  if (!text.ok() || text->size() <= begin) return {};
  const std::size_t from = std::max<std::size_t>(begin, text->size() > kTailBytes ? text->size() - kTailBytes : 0);
  return text->substr(from);
}

// The port in "listening on tcp://0.0.0.0:7700".
std::optional<int> PortOf(const std::string& log) {
  const std::size_t line = log.rfind("listening on tcp://");
  const std::size_t end = line == std::string::npos ? line : log.find('\n', line);
  if (end == std::string::npos) return std::nullopt;
  const std::size_t colon = log.rfind(':', end);
  int port = 0;
  const auto [rest, error] = std::from_chars(log.data() + colon + 1, log.data() + end, port);
  if (error != std::errc() || rest != log.data() + end) return std::nullopt;
  return port;
}

std::vector<std::string> IdsOf(const std::vector<Pilot>& pilots) {
  std::vector<std::string> ids;
  std::ranges::transform(pilots, std::back_inserter(ids), &Pilot::id);
  return ids;
}

std::string Count(std::size_t number, const std::string& thing) {
  return std::to_string(number) + " " + thing + (number == 1 ? "" : "s");
}

std::string Seconds(milliseconds time) { return std::to_string(time.count() / 1000) + " s"; }

ScalerOptions ScalerOptionsOf(const ClusterOptions& options, const std::string& instance) {
  return {.cluster = instance,
          .min_workers = options.workers.min,
          .max_workers = options.workers.max,
          .slots_per_worker = options.slots,
          .idle = std::chrono::seconds(options.idle_seconds)};
}

}  // namespace

Result<std::unique_ptr<Engine>> OpenEngine(const ClusterRecord& record, const ClusterFolder& folder, InHurry in_hurry) {
  const ClusterOptions& options = record.options;
  PilotSpec spec{.cluster = record.instance,
                 .worker_program = options.worker_program,
                 .coordinator = record.coordinator,
                 .keys_dir = record.keys_dir,
                 .insecure = options.insecure,
                 .slots = options.slots,
                 .threads = options.threads,
                 .memory_bytes = options.worker_memory_bytes,
                 .cache_dir = options.cache_dir,
                 .cache_size = options.cache_size,
                 .tags = options.tags,
                 .path_map = options.path_map};
  if (options.engine == EngineKind::kSlurm) {
    DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<SlurmEngine> slurm,
                               SlurmEngine::Open({.partition = options.partition,
                                                  .time = options.time,
                                                  .account = options.account,
                                                  .qos = options.qos,
                                                  .arguments = options.engine_arguments,
                                                  .log_dir = folder.logs().string()},
                                                 std::move(spec), "depthfarm-" + record.instance, std::move(in_hurry)));
    return std::unique_ptr<Engine>(std::move(slurm));
  }
  ProcessEngine::Options processes;
  processes.ssh_arguments = options.engine_arguments;
  processes.log_dir = folder.logs();
  if (options.engine == EngineKind::kSsh) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, ReadFileBytes(options.hosts_file, kMostHostsBytes));
    Result<std::vector<SshHost>> hosts = ParseSshHosts(text);
    if (!hosts.ok()) return hosts.status().WithContext(options.hosts_file);
    int room = 0;
    for (const SshHost& host : *hosts) room += host.workers;
    if (room < options.workers.max) {
      return InvalidArgument(options.hosts_file + " has room for " + Count(static_cast<std::size_t>(room), "worker") +
                             ", --workers asks for up to " + std::to_string(options.workers.max));
    }
    processes.hosts = std::move(*hosts);
  }
  return std::unique_ptr<Engine>(std::make_unique<ProcessEngine>(std::move(processes), std::move(spec)));
}

Status RemoveLeftovers(const ClusterRecord& record, const ClusterFolder& folder) {
  // Of the other engines nothing outlives the manager but workers that end by themselves.
  if (record.options.engine != EngineKind::kSlurm) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<Engine> engine, OpenEngine(record, folder));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<Pilot> pilots, engine->List());
  return engine->Cancel(IdsOf(pilots));
}

Cluster::Cluster(ClusterOptions options, ClusterFolder folder, Log log, InHurry in_hurry)
    : options_(std::move(options)),
      folder_(std::move(folder)),
      log_(std::move(log)),
      in_hurry_(std::move(in_hurry)),
      instance_(NewInstance(options_.name)),
      port_(options_.port),
      scaler_(ScalerOptionsOf(options_, instance_)) {}

Result<std::unique_ptr<Cluster>> Cluster::Start(const ClusterOptions& options, const ClusterFolder& folder, Log log,
                                                InHurry in_hurry) {
  DEPTHFARM_RETURN_IF_ERROR(CheckClusterOptions(options));
  std::unique_ptr<Cluster> cluster(new Cluster(options, folder, std::move(log), std::move(in_hurry)));
  ClusterOptions& effective = cluster->options_;
  // Workers of this machine share its memory.
  if (effective.engine == EngineKind::kLocal && effective.worker_memory_bytes == 0) {
    effective.worker_memory_bytes = MachineMemory() / static_cast<std::uint64_t>(effective.workers.max);
  }
  if (effective.worker_program.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const fs::path worker, SiblingProgram("depthfarm-worker"));
    effective.worker_program = worker.string();
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path coordinator, SiblingProgram("depthfarm-coordinator"));
  cluster->coordinator_program_ = coordinator.string();
  ClusterRecord& record = cluster->record_;
  record.coordinator = effective.coordinator;
  record.keys_dir = effective.keys_dir;
  if (effective.coordinator.empty()) {
    record.keys_dir = folder.keys().string();
    if (!fs::exists(folder.keys() / "coordinator.key")) DEPTHFARM_RETURN_IF_ERROR(CreateFarmKeys(folder.keys()));
    DEPTHFARM_RETURN_IF_ERROR(cluster->StartCoordinator());
    // Local workers need no name that others can resolve.
    const std::string local = effective.engine == EngineKind::kLocal ? "127.0.0.1" : HostName();
    record.coordinator =
        "tcp://" + (effective.host.empty() ? local : effective.host) + ":" + std::to_string(cluster->port_);
  }
  record.options = effective;
  record.instance = cluster->instance_;
  record.manager_host = HostName();
  record.manager_pid = ::getpid();
  record.started = FormatUtc(std::chrono::system_clock::now());
  DEPTHFARM_ASSIGN_OR_RETURN(cluster->engine_, OpenEngine(record, folder, cluster->in_hurry_));
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<Client> client,
                             Client::Connect(cluster->target(), {.timeout = kAnswerLimit, .stop = nullptr}));
  // Nobody is to be told of a cluster that cannot be reached.
  const Status reached = client->GetBacklog(effective.tags).status();
  if (!reached.ok()) return reached.WithContext("coordinator " + record.coordinator);
  cluster->client_ = std::move(client);
  DEPTHFARM_RETURN_IF_ERROR(folder.WriteRecord(record));
  cluster->log_("cluster " + effective.name + " is up: coordinator " + record.coordinator);
  return cluster;
}

Cluster::~Cluster() { Stop(); }

CoordinatorTarget Cluster::target() const {
  std::string endpoint = record_.coordinator;
  if (coordinator_) endpoint = "tcp://127.0.0.1:" + std::to_string(port_);
  return {.endpoint = endpoint, .keys_dir = record_.keys_dir, .insecure = options_.insecure};
}

Status Cluster::StartCoordinator() {
  const std::string interface = options_.engine == EngineKind::kLocal && options_.host.empty() ? "127.0.0.1" : "*";
  const std::string port = port_ == 0 ? "*" : std::to_string(port_);
  const fs::path log = folder_.logs() / "coordinator.log";
  std::error_code missing;
  const std::uintmax_t size = fs::file_size(log, missing);
  const std::uintmax_t begin = missing ? 0 : size;
  DEPTHFARM_ASSIGN_OR_RETURN(
      ChildProcess coordinator,
      ChildProcess::Start(coordinator_program_,
                          {"--listen", "tcp://" + interface + ":" + port, "--keys", record_.keys_dir, "--journal",
                           options_.keeps_journal ? folder_.journal().string() : "none"},
                          log));
  const auto deadline = SteadyClock::now() + kStartLimit;
  for (;;) {
    const std::string written = TailFrom(log, begin);
    if (const std::optional<int> listening = PortOf(written)) {
      port_ = *listening;
      coordinator_.emplace(std::move(coordinator));
      return {};
    }
    if (const std::optional<ProcessEnd> end = coordinator.WaitFor(milliseconds(20))) {
      return Unavailable("the coordinator " + Describe(*end) + ":\n" + TailFrom(log, begin));
    }
    if (SteadyClock::now() > deadline) return Unavailable("the coordinator does not start, see " + log.string());
  }
}

Status Cluster::LookAfterCoordinator() {
  if (!coordinator_) return {};
  const std::optional<ProcessEnd> end = coordinator_->Poll();
  if (!end) return {};
  if (restarts_ >= kMostRestarts || !options_.keeps_journal) {
    return Internal("the coordinator " + Describe(*end) + ", see " + (folder_.logs() / "coordinator.log").string());
  }
  ++restarts_;
  log_("the coordinator " + Describe(*end) + "; starting it again");
  return StartCoordinator();
}

Result<ClusterView> Cluster::Look() {
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Backlog backlog, client_->GetBacklog(options_.tags));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<v1::WorkerStatus> workers, client_->ListWorkers());
  ClusterView view;
  DEPTHFARM_ASSIGN_OR_RETURN(view.pilots, engine_->List());
  view.wanted_slots = backlog.leased() + backlog.ready() + backlog.unopened_gops();
  for (const v1::WorkerStatus& worker : workers) {
    view.workers.push_back({worker.name(), worker.tasks() > 0, worker.draining()});
  }
  return view;
}

void Cluster::TellTrouble(const std::string& trouble) {
  if (trouble == trouble_) return;
  trouble_ = trouble;
  if (!trouble.empty()) log_(trouble);
}

void Cluster::CarryOut(const ScalingDecision& decision) {
  for (const std::string& pilot : decision.failed) {
    const std::string tail = TailFrom(folder_.logs() / ("worker-" + pilot + ".log"), 0);
    log_("worker " + pilot + " ended before it had joined" + (tail.empty() ? "" : ":\n" + tail));
  }
  if (decision.vanished > 0) {
    log_(Count(static_cast<std::size_t>(decision.vanished), "worker") + " ended at once, see " +
         folder_.logs().string());
  }
  if (decision.pause) log_("no worker is started for " + Seconds(*decision.pause));
  std::string trouble;
  if (decision.launch > 0) {
    const Status launched = engine_->Launch(decision.launch);
    if (launched.ok()) {
      log_("asked for " + Count(static_cast<std::size_t>(decision.launch), "more worker"));
    } else {
      log_(launched.message() + "; asking again in " + Seconds(scaler_.LaunchFailed(*looked_at_)));
    }
  }
  if (!decision.cancel.empty()) {
    const Status cancelled = engine_->Cancel(decision.cancel);
    log_(cancelled.ok() ? "took back the request for " + Count(decision.cancel.size(), "worker") : cancelled.message());
  }
  for (const std::string& worker : decision.drain) {
    const Status drained = client_->Drain(worker);
    // One that left by itself meanwhile is no trouble.
    if (drained.ok()) log_("worker " + worker + " is not needed and leaves");
    if (drained.code() == ErrorCode::kUnavailable) trouble = drained.message();
  }
  TellTrouble(trouble);
}

Status Cluster::Tick() {
  const auto now = SteadyClock::now();
  if (looked_at_ && now - *looked_at_ < kLookInterval) return {};
  looked_at_ = now;
  DEPTHFARM_RETURN_IF_ERROR(LookAfterCoordinator());
  const Result<ClusterView> view = Look();
  if (!view.ok()) {
    TellTrouble(view.status().message());
    return {};
  }
  CarryOut(scaler_.Decide(*view, now));
  return {};
}

void Cluster::WaitForPilots(milliseconds limit) {
  const auto deadline = SteadyClock::now() + limit;
  while (SteadyClock::now() < deadline) {
    const Result<std::vector<Pilot>> pilots = engine_->List();
    if (pilots.ok() && std::ranges::none_of(*pilots, &Pilot::running)) return;
    // They end by the coordinator's word, or when they miss it.
    if (!pilots.ok() && in_hurry_ && in_hurry_()) return;
    std::this_thread::sleep_for(milliseconds(200));
  }
}

void Cluster::Stop() {
  if (std::exchange(stopped_, true)) return;
  if (engine_ && client_) {
    // Those that wait must not start any more; those that run end by the coordinator's word, and if they do not, by
    // the engine's.
    const Result<std::vector<Pilot>> pilots = engine_->List();
    if (pilots.ok()) {
      std::vector<Pilot> waiting;
      std::ranges::copy_if(*pilots, std::back_inserter(waiting), [](const Pilot& pilot) { return !pilot.running; });
      if (const Status cancelled = engine_->Cancel(IdsOf(waiting)); !cancelled.ok()) log_(cancelled.message());
    }
    if (coordinator_) {
      if (const Status asked = client_->StopCoordinator(); !asked.ok()) coordinator_->Signal(SIGTERM);
    } else if (const Result<std::vector<v1::WorkerStatus>> workers = client_->ListWorkers(); workers.ok()) {
      for (const v1::WorkerStatus& worker : *workers) {
        // It may have left meanwhile.
        if (PilotOfWorker(instance_, worker.name())) (void)client_->Drain(worker.name());
      }
    }
    WaitForPilots(kLeaveLimit);
    const Result<std::vector<Pilot>> left = engine_->List();
    if (left.ok() && !left->empty()) {
      if (const Status cancelled = engine_->Cancel(IdsOf(*left)); !cancelled.ok()) log_(cancelled.message());
      WaitForPilots(kCancelLimit);
    }
    log_("cluster " + options_.name + " is down");
  }
  if (coordinator_) coordinator_->Stop(kStopGrace);
  folder_.RemoveRecord();
}

}  // namespace depthfarm
