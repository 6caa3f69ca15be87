#include "worker/service/worker_service.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <random>
#include <utility>

#include "common/base/boot_time.h"
#include "common/base/freed_memory.h"
#include "common/base/host_name.h"
#include "common/base/machine_memory.h"
#include "common/log/log.h"
#include "common/log/log_collector.h"
#include "common/transport/endpoint.h"
#include "common/wire/bounds.h"
#include "common/wire/job_wire.h"
#include "common/wire/task_wire.h"
#include "worker/service/local_paths.h"
#include "worker/transfer/addresses.h"

namespace depthfarm {
namespace {

namespace event = lifecycle_event;
namespace action = lifecycle_action;

constexpr Milliseconds kLongestWait{500};  // between looks at what the store dropped

TimePoint Now() { return BootTime(); }

int ThreadsOf(const WorkerOptions& options) { return std::max(options.threads, options.slots); }

// Tells apart the workers of one host, and those of containers that share a host name and number their processes alike.
std::string UniqueName() { return std::to_string(getpid()) + "-" + std::to_string(std::random_device()()); }

}  // namespace

void Identify(WorkerOptions& options) {
  if (options.name.empty()) options.name = HostName() + ":" + UniqueName();
  if (options.process == 0)
    options.process = (std::uint64_t{std::random_device()()} << 32U) | std::random_device()() | 1U;
}

Result<std::unique_ptr<WorkerService>> WorkerService::Create(const WorkerOptions& options) {
  WorkerOptions identified = options;
  Identify(identified);
  std::unique_ptr<WorkerService> service(new WorkerService(identified));
  DEPTHFARM_RETURN_IF_ERROR(service->Open());
  return service;
}

WorkerService::WorkerService(const WorkerOptions& options) : options_(options), threads_(ThreadsOf(options)) {}

Status WorkerService::Open() {
  DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint coordinator, ParseEndpoint(options_.coordinator));
  std::optional<WorkerKeys> keys;
  if (!options_.keys.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(keys, ReadWorkerKeys(options_.keys));
    DEPTHFARM_RETURN_IF_ERROR(context_.Authenticate(keys->allowed_peers));
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckSecurity(coordinator, keys.has_value(), options_.insecure));
  identity_.name = options_.name;
  identity_.process = options_.process;
  identity_.software_version = options_.software_version;
  identity_.memory_bytes =
      options_.task_memory_bytes > 0 ? options_.task_memory_bytes : TaskMemory(MachineMemory(), options_.memory_bytes);
  identity_.tags = options_.tags;
  identity_.slots = options_.slots;
  identity_.ahead = options_.ahead;
  identity_.artifacts.endpoint =
      options_.artifact_listen.empty() ? DefaultArtifactEndpoint(coordinator, UniqueName()) : options_.artifact_listen;
  DEPTHFARM_RETURN_IF_ERROR(OpenArtifacts(keys));

  ClientOptions channel;
  if (keys.has_value() && coordinator.kind == Endpoint::Kind::kTcp) {
    channel.curve_server_public_key = keys->coordinator_public_key;
    channel.curve_own = keys->own;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(coordinator_, ClientChannel::Connect(context_, options_.coordinator, channel));
  LifecycleOptions lifecycle;
  lifecycle.capacity = options_.slots + options_.ahead;
  lifecycle.give_up = options_.give_up;
  lifecycle_ = std::make_unique<Lifecycle>(lifecycle, Now());
  compute_ = std::make_unique<ComputePool>(
      options_.slots,
      [this](int slot, const LeasedTask& task, const std::stop_token& stop) {
        const ThreadBudget::Task of_budget(threads_);
        if (options_.computing) options_.computing->Begin(slot, task.lease);
        LogCollector collector(
            {.lines = kMaxTaskLogLines, .bytes = kMaxTaskLogBytes, .line_bytes = kMaxTaskLogLineBytes});
        TaskOutcome outcome = executors_[static_cast<std::size_t>(slot)]->Execute(
            task.spec, *task.config, stop, [&task] { return !task.term->over(); });
        outcome.status = options_.paths.Explain(outcome.status);
        outcome.log = {collector.TakeLines(), collector.left_out()};
        if (options_.computing) options_.computing->End(slot);
        return outcome;
      },
      [this](const TaskSpec& spec, const std::stop_token& stop, const std::stop_token& enough) {
        return FetchAhead(*store_, *fetchers_.back(), spec, stop, enough);
      },
      [this] { poller_.Wake(); });
  return {};
}

Status WorkerService::OpenArtifacts(const std::optional<WorkerKeys>& keys) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint listen, ParseEndpoint(identity_.artifacts.endpoint));
  DEPTHFARM_RETURN_IF_ERROR(CheckSecurity(listen, keys.has_value(), options_.insecure));
  const bool curve = keys.has_value() && listen.kind == Endpoint::Kind::kTcp;
  DEPTHFARM_ASSIGN_OR_RETURN(store_, ArtifactStore::Open(options_.cache_dir, options_.cache_bytes));
  DEPTHFARM_ASSIGN_OR_RETURN(server_, ArtifactServer::Start(context_, *store_, identity_.artifacts.endpoint,
                                                            curve ? keys->own.secret_key : ""));
  const std::string host = options_.advertise.empty() ? HostName() : options_.advertise;
  DEPTHFARM_ASSIGN_OR_RETURN(identity_.artifacts.endpoint,
                             AdvertisedEndpoint(listen, server_->endpoint(), host, !options_.advertise.empty()));
  if (curve) identity_.artifacts.public_key = keys->own.public_key;

  FetchOptions fetch;
  fetch.max_artifact_bytes = options_.cache_bytes;
  cache_ = std::make_unique<MemoryCache>(options_.memory_bytes);
  for (int i = 0; i <= options_.slots; ++i) {
    fetchers_.push_back(
        std::make_unique<PeerFetcher>(ArtifactClient(context_, curve ? keys->own : CurveKeys{}, fetch)));
  }
  for (int slot = 0; slot < options_.slots; ++slot) {
    executors_.push_back(std::make_unique<TaskExecutor>(*store_, *cache_, *fetchers_[static_cast<std::size_t>(slot)],
                                                        ThreadsOf(options_), options_.roots));
  }
  return {};
}

void WorkerService::Stop() {
  stop_requested_ = true;
  poller_.Wake();
}

void WorkerService::RereadKeys() {
  reread_ = true;
  poller_.Wake();
}

void WorkerService::ReadmitPeers() {
  Result<WorkerKeys> keys = ReadWorkerKeys(options_.keys);
  const Status replaced = keys.ok() ? context_.Readmit(keys->allowed_peers) : keys.status();
  if (replaced.ok()) {
    LogInfo("keys_reread", {{"keys", keys->allowed_peers.size()}});
  } else {
    LogWarning("keys_not_reread", {{"reason", replaced.message()}});
  }
}

Status WorkerService::Run() {
  LogInfo("worker_started", {{"name", identity_.name},
                             {"coordinator", options_.coordinator},
                             {"artifacts", identity_.artifacts.endpoint},
                             {"cache", options_.cache_dir.string()},
                             {"held", store_->List().size()}});
  const Channel* const channels[] = {coordinator_.get()};
  while (!exit_.has_value()) {
    if (stop_requested_.exchange(false)) OnStopSignal();
    if (reread_.exchange(false)) ReadmitPeers();
    DEPTHFARM_RETURN_IF_ERROR(ReceiveAll());
    while (std::optional<LeasedOutcome> outcome = compute_->TakeOutcome()) OnOutcome(std::move(*outcome));
    ReportDropped();
    CarryOut(lifecycle_->Tick(Now()));
    if (exit_.has_value()) break;
    DEPTHFARM_RETURN_IF_ERROR(poller_.Wait(channels, UntilNextDue()));
  }
  LogInfo("worker_stopped", {{"name", identity_.name}, {"reason", exit_->ok() ? "asked to" : exit_->message()}});
  return *exit_;
}

void WorkerService::OnStopSignal() {
  LogInfo("stop_asked", {{"finish_ms", options_.stop_grace.count()}});
  Handle(event::StopRequested{options_.stop_grace});
}

Milliseconds WorkerService::UntilNextDue() const {
  const TimePoint now = Now();
  const TimePoint due = std::min(lifecycle_->NextDue(), now + kLongestWait);
  return std::max(Milliseconds(0), std::chrono::ceil<Milliseconds>(due - now));
}

Status WorkerService::ReceiveAll() {
  while (!exit_.has_value()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<std::string> bytes, coordinator_->Receive(Milliseconds(0)));
    if (!bytes.has_value()) return {};
    const Result<v1::Envelope> message = ParseEnvelope(*bytes);
    if (message.ok()) {
      OnMessage(*message);
    } else if (message.status().code() == ErrorCode::kIncompatible) {
      Handle(event::Refused{message.status().WithContext("coordinator")});
    } else {
      LogWarning("message_refused", {{"reason", message.status().message()}});
    }
  }
  return {};
}

void WorkerService::OnMessage(const v1::Envelope& message) {
  switch (message.body_case()) {
    case v1::Envelope::kWorkerWelcome: {
      const v1::WorkerWelcome& welcome = message.worker_welcome();
      if (welcome.heartbeat_ms() == 0 || welcome.lease_ms() <= welcome.heartbeat_ms()) {
        LogWarning("message_refused", {{"message", BodyName(message)},
                                       {"heartbeat_ms", welcome.heartbeat_ms()},
                                       {"lease_ms", welcome.lease_ms()}});
        return;
      }
      LogInfo("welcomed", {{"worker", welcome.worker_id()},
                           {"heartbeat_ms", welcome.heartbeat_ms()},
                           {"lease_ms", welcome.lease_ms()}});
      store_->KeepNone();  // whoever welcomes it says next what is wanted
      Handle(event::Welcomed{Milliseconds(welcome.heartbeat_ms()), Milliseconds(welcome.lease_ms())});
      return;
    }
    case v1::Envelope::kError: {
      const Status reason = FromProto(message.error());
      LogWarning("refused", {{"code", ErrorCodeName(reason.code())}, {"reason", reason.message()}});
      Handle(event::Refused{reason});
      return;
    }
    case v1::Envelope::kGrantTask:
      OnGrant(message.grant_task());
      return;
    case v1::Envelope::kHeartbeatAck: {
      event::HeartbeatAcked ack{message.heartbeat_ack().heartbeat_id(), {}};
      for (const std::uint64_t lease : message.heartbeat_ack().unknown_leases()) ack.unknown_leases.emplace_back(lease);
      Handle(ack);
      return;
    }
    case v1::Envelope::kRevokeLease:
      Handle(event::Revoked{LeaseId(message.revoke_lease().lease_id())});
      return;
    case v1::Envelope::kGiveBackTask: {
      const LeaseId lease(message.give_back_task().lease_id());
      LogInfo("task_asked_back", {{"lease", lease.value()}, {"given_back", compute_->GiveBack(lease)}});
      return;
    }
    case v1::Envelope::kReleaseArtifacts: {
      const Result<std::vector<ArtifactKey>> keys = KeysOf(message.release_artifacts());
      if (keys.ok()) {
        store_->Release(*keys);
      } else {
        LogWarning("message_refused", {{"reason", keys.status().message()}});
      }
      return;
    }
    case v1::Envelope::kKeepArtifacts: {
      const Result<std::vector<ArtifactKey>> keys = KeysOf(message.keep_artifacts());
      if (keys.ok()) {
        store_->Keep(*keys);
      } else {
        LogWarning("message_refused", {{"reason", keys.status().message()}});
      }
      return;
    }
    case v1::Envelope::kJobEnded:
      jobs_.erase(JobId(message.job_ended().job_id()));
      return;
    case v1::Envelope::kStopWorker:
      Handle(event::StopRequested{});
      return;
    default:
      LogWarning("message_refused", {{"message", BodyName(message)}, {"reason", "not for a worker"}});
  }
}

void WorkerService::OnGrant(const v1::GrantTask& grant) {
  const LeaseId lease(grant.lease_id());
  const auto refuse = [&](const Status& reason) {
    LogWarning("grant_refused", {{"lease", grant.lease_id()}, {"reason", reason.message()}});
    Send(FailedMessage(lease, grant.task().id(), reason));
  };
  Result<TaskSpec> spec = FromProto(grant.task());
  if (!spec.ok()) return refuse(spec.status().WithContext("granted task"));
  if (grant.has_job()) {
    Result<JobConfig> config = FromProto(grant.job());
    if (!config.ok()) return refuse(config.status().WithContext("job of the granted task"));
    if (config->job != spec->id.job)
      return refuse(InvalidArgument("the granted task is not of the job that came along"));
    jobs_[config->job] = std::make_shared<const JobConfig>(WithLocalPaths(std::move(*config), options_.paths));
  }
  const auto job = jobs_.find(spec->id.job);
  if (job == jobs_.end() || job->second->claim != grant.claim())
    return refuse({ErrorCode::kLeaseExpired, "this worker was never told of this run of the job"});
  granted_ = LeasedTask{lease, WithLocalPaths(std::move(*spec), options_.paths), job->second, nullptr};
  Handle(event::Granted{lease, grant.ask_id()});
  granted_.reset();
}

void WorkerService::OnOutcome(LeasedOutcome outcome) {
  const TaskStats& stats = outcome.outcome.stats;
  LogInfo("task_ended", {{"lease", outcome.lease.value()},
                         {"task", TaskName(outcome.task)},
                         {"code", ErrorCodeName(outcome.outcome.status.code())},
                         {"reason", outcome.outcome.status.message()},
                         {"wall_s", stats.wall_seconds},
                         {"cpu_s", stats.cpu_seconds},
                         {"fetched_bytes", stats.fetched_bytes},
                         {"reused", stats.reused}});
  const LeaseId lease = outcome.lease;
  terms_.erase(lease);
  ended_ = std::move(outcome);
  Handle(event::TaskEnded{lease});
  ended_.reset();
}

void WorkerService::RenewTerms() {
  for (const auto& [lease, term] : terms_) {
    term->Set(lifecycle_->ExpiryOf(lease).value_or(TimePoint()));
  }
}

void WorkerService::ReportDropped() {
  const std::vector<ArtifactKey> dropped = store_->TakeDropped();
  if (!dropped.empty()) Send(DroppedMessage(dropped));
}

void WorkerService::Handle(const LifecycleEvent& event) { CarryOut(lifecycle_->Handle(event, Now())); }

void WorkerService::CarryOut(const std::vector<LifecycleAction>& actions) {
  for (const LifecycleAction& next : actions) {
    std::visit([this](const auto& wanted) { Do(wanted); }, next);
  }
  RenewTerms();
}

void WorkerService::Do(const action::SendHello& hello) {
  LogInfo("hello", {{"coordinator", options_.coordinator}, {"running", hello.running.size()}});
  // What was dropped before is not in the list; telling of it afterwards would be about a newer copy of it.
  (void)store_->TakeDropped();
  Send(HelloMessage(identity_, store_->List(), hello.running));
}

void WorkerService::Do(const action::SendAsk& ask) { Send(AskMessage(ask.ask_id, ask.running)); }

void WorkerService::Do(const action::SendHeartbeat& beat) {
  Send(HeartbeatMessage(beat.heartbeat_id, beat.running));
  if (beat.running.empty() && std::exchange(keeps_freed_memory_, false)) ReturnFreedMemory();
}

void WorkerService::Do(const action::StartTask& start) {
  LogInfo("task_started", {{"lease", start.lease.value()}, {"task", TaskName(granted_->spec.id)}});
  granted_->term = std::make_shared<LeaseTerm>(lifecycle_->ExpiryOf(start.lease).value());
  terms_[start.lease] = granted_->term;
  keeps_freed_memory_ = true;
  compute_->Start(std::move(*granted_));
}

void WorkerService::Do(const action::StopTask& stop) {
  LogInfo("task_stopped", {{"lease", stop.lease.value()}, {"reason", stop.reason}});
  compute_->Stop(stop.lease);
}

void WorkerService::Do(const action::ReportTask&) { Send(FinishedMessage(*ended_)); }

void WorkerService::Do(const action::DropResult& drop) { LogInfo("result_dropped", {{"lease", drop.lease.value()}}); }

void WorkerService::Do(const action::RefuseGrant& refusal) {
  LogInfo("grant_refused", {{"lease", refusal.lease.value()}, {"reason", refusal.reason}});
  Send(FailedMessage(refusal.lease, ToProto(granted_->spec.id), {ErrorCode::kLeaseExpired, refusal.reason}));
}

void WorkerService::Do(const action::SendGoodbye&) { Send(GoodbyeMessage()); }

void WorkerService::Do(const action::Exit& exit) { exit_ = exit.status; }

void WorkerService::Send(v1::Envelope message) {
  const std::string name = BodyName(message);
  const Status sent = coordinator_->Send(SerializeEnvelope(std::move(message)));
  // A message that finds the queue full is lost like one on a cut cable: leases and heartbeats are made for that.
  if (!sent.ok()) LogWarning("message_lost", {{"message", name}, {"reason", sent.message()}});
}

}  // namespace depthfarm
