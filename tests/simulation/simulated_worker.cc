#include "tests/simulation/simulated_worker.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <ranges>
#include <utility>
#include <variant>

#include "common/digest/sha256.h"
#include "common/job/job_manifest.h"
#include "common/wire/job_wire.h"
#include "common/wire/task_wire.h"
#include "coordinator/planning/job_plan.h"
#include "tests/simulation/task_model.h"
#include "worker/execution/output_folder.h"
#include "worker/execution/views_manifest.h"

namespace depthfarm::simulation {
namespace {

namespace event = lifecycle_event;
namespace action = lifecycle_action;

// Of jobs that go wrong in a way of their own: named so by who submits them.
constexpr const char* kPoison = "poison";
constexpr const char* kUnreadable = "unreadable";

bool NeedsFolder(TaskKind kind) {
  return kind == TaskKind::kPrepare || kind == TaskKind::kCommit || kind == TaskKind::kManifest ||
         kind == TaskKind::kCleanup;
}

}  // namespace

SimulatedWorker::SimulatedWorker(std::string name, WorkerShape shape, Surroundings& around)
    : name_(std::move(name)), shape_(std::move(shape)), around_(around) {}

std::string SimulatedWorker::endpoint() const { return "tcp://" + name_ + ":" + std::to_string(10'000 + life_); }

void SimulatedWorker::Start() {
  ++life_;
  LifecycleOptions options;
  options.capacity = shape_.slots + shape_.ahead;
  lifecycle_ = std::make_unique<Lifecycle>(options, around_.events.now());
  exited_ = false;
  tick_planned_ = TimePoint::max();
  hung_until_.reset();
  Reconnect();
  for (auto& [key, stored] : store_) stored.kept = false;
  Do(Thread::kNetwork, [] {});
}

void SimulatedWorker::Reconnect() { peer_ = name_ + "#" + std::to_string(++connection_); }

void SimulatedWorker::Crash() {
  ++life_;
  lifecycle_.reset();
  tasks_.clear();
  jobs_.clear();
  waiting_.clear();
  dropped_.clear();
  hung_until_.reset();
}

void SimulatedWorker::Die() {
  if (around_.tells_deaths && around_.random.Chance(50)) {
    ++deaths_told_;
    std::vector<LeaseId> computing;
    for (const Running& task : tasks_) {
      if (task.computing) computing.push_back(task.lease);
    }
    const auto process = static_cast<std::uint64_t>(life_);
    around_.send_beside(name_, SerializeEnvelope(DiedMessage(name_, process, "was killed", {}, computing)));
  }
  Crash();
}

void SimulatedWorker::Hang(Milliseconds time) {
  if (!alive()) return;
  hung_until_ = std::max(hung_until_.value_or(TimePoint()), around_.events.now() + time);
  around_.events.At(*hung_until_, [this, life = life_] {
    if (life == life_ && hung_until_ == around_.events.now()) WakeUp();
  });
}

void SimulatedWorker::WakeUp() {
  hung_until_.reset();
  // Its threads go on in whatever order.
  const bool computes_first = around_.random.Chance(50);
  for (const Thread thread :
       {computes_first ? Thread::kCompute : Thread::kNetwork, computes_first ? Thread::kNetwork : Thread::kCompute}) {
    for (const EventQueue::Action& next : std::exchange(waiting_[thread], {})) Do(thread, next);
  }
}

void SimulatedWorker::After(Milliseconds pause, Thread thread, EventQueue::Action next) {
  around_.events.After(pause, [this, thread, life = life_, next = std::move(next)] {
    if (life == life_) Do(thread, next);
  });
}

void SimulatedWorker::Do(Thread thread, const EventQueue::Action& next) {
  if (!alive()) return;
  if (hung()) {
    waiting_[thread].push_back(next);
  } else {
    Run(next);
  }
}

void SimulatedWorker::Run(const EventQueue::Action& next) {
  next();
  if (!alive()) return;
  if (!dropped_.empty()) Send(DroppedMessage(std::exchange(dropped_, {})));
  CarryOut(lifecycle_->Tick(around_.events.now()));
  if (exited_) {
    Crash();
  } else {
    PlanTick();
  }
}

void SimulatedWorker::PlanTick() {
  const TimePoint due = lifecycle_->NextDue();
  if (due >= tick_planned_) return;
  tick_planned_ = due;
  around_.events.At(due, [this, life = life_] {
    if (life != life_) return;
    tick_planned_ = TimePoint::max();
    Do(Thread::kNetwork, [] {});
  });
}

Milliseconds SimulatedWorker::Slowly(int from, int to) {
  return Milliseconds(around_.random.Int(from, to) * slowness_);
}

void SimulatedWorker::Stop() {
  Do(Thread::kNetwork, [this] { Handle(event::StopRequested{}); });
}

void SimulatedWorker::Receive(const std::string& peer, const std::string& payload) {
  if (peer != peer_) return;
  Do(Thread::kNetwork, [this, payload] {
    const Result<v1::Envelope> message = ParseEnvelope(payload);
    if (message.ok()) OnMessage(*message);
  });
}

void SimulatedWorker::OnMessage(const v1::Envelope& message) {
  switch (message.body_case()) {
    case v1::Envelope::kWorkerWelcome:
      for (auto& [key, stored] : store_) stored.kept = false;
      Handle(event::Welcomed{Milliseconds(message.worker_welcome().heartbeat_ms()),
                             Milliseconds(message.worker_welcome().lease_ms())});
      return;
    case v1::Envelope::kError:
      Handle(event::Refused{FromProto(message.error())});
      return;
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
      const auto task = Find(LeaseId(message.give_back_task().lease_id()));
      if (task == tasks_.end() || task->computing) return;
      ++tasks_given_back_;
      TaskOutcome outcome;
      outcome.status = Cancelled();
      EndTask(task->lease, outcome);
      return;
    }
    case v1::Envelope::kReleaseArtifacts: {
      const std::vector<ArtifactKey> keys = KeysOf(message.release_artifacts()).value();
      for (const ArtifactKey& key : keys) {
        if (const auto stored = store_.find(key); stored != store_.end()) {
          stored->second.released = true;
          stored->second.kept = false;
        }
      }
      return;
    }
    case v1::Envelope::kKeepArtifacts: {
      const std::vector<ArtifactKey> keys = KeysOf(message.keep_artifacts()).value();
      for (const ArtifactKey& key : keys) {
        if (const auto stored = store_.find(key); stored != store_.end()) stored->second.kept = true;
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
      return;
  }
}

void SimulatedWorker::OnGrant(const v1::GrantTask& grant) {
  const LeaseId lease(grant.lease_id());
  TaskSpec spec = FromProto(grant.task()).value();
  if (grant.has_job()) jobs_[spec.id.job] = std::make_shared<const JobConfig>(FromProto(grant.job()).value());
  const auto job = jobs_.find(spec.id.job);
  if (job == jobs_.end() || job->second->claim != grant.claim()) {
    Send(FailedMessage(lease, grant.task().id(), {ErrorCode::kLeaseExpired, "was never told of this run of the job"}));
    return;
  }
  granted_ = Running{lease, std::move(spec), job->second};
  Handle(event::Granted{lease, grant.ask_id()});
  granted_.reset();
}

void SimulatedWorker::Handle(const LifecycleEvent& event) { CarryOut(lifecycle_->Handle(event, around_.events.now())); }

void SimulatedWorker::CarryOut(const std::vector<LifecycleAction>& actions) {
  for (const LifecycleAction& next : actions) Carry(next);
}

void SimulatedWorker::Carry(const LifecycleAction& wanted) {
  if (const auto* hello = std::get_if<action::SendHello>(&wanted)) {
    dropped_.clear();
    std::vector<ArtifactInfo> held;
    for (const auto& [key, stored] : store_) held.push_back(stored.info);
    const WorkerIdentity identity{name_,
                                  "simulated",
                                  0,
                                  shape_.slots,
                                  shape_.ahead,
                                  shape_.tags,
                                  {endpoint(), ""},
                                  static_cast<std::uint64_t>(life_)};
    Send(HelloMessage(identity, held, hello->running));
  } else if (const auto* ask = std::get_if<action::SendAsk>(&wanted)) {
    Send(AskMessage(ask->ask_id, ask->running));
  } else if (const auto* beat = std::get_if<action::SendHeartbeat>(&wanted)) {
    Send(HeartbeatMessage(beat->heartbeat_id, beat->running));
  } else if (std::holds_alternative<action::StartTask>(wanted)) {
    tasks_.push_back(std::move(*granted_));
    BeginTasks();
  } else if (const auto* stop = std::get_if<action::StopTask>(&wanted)) {
    StopTask(stop->lease);
  } else if (std::holds_alternative<action::ReportTask>(wanted)) {
    Send(FinishedMessage(*ended_));
  } else if (const auto* refusal = std::get_if<action::RefuseGrant>(&wanted)) {
    Send(FailedMessage(refusal->lease, ToProto(granted_->spec.id), {ErrorCode::kLeaseExpired, refusal->reason}));
  } else if (std::holds_alternative<action::SendGoodbye>(wanted)) {
    Send(GoodbyeMessage());
  } else if (std::holds_alternative<action::Exit>(wanted)) {
    exited_ = true;
  }
}

void SimulatedWorker::Send(v1::Envelope message) { around_.send(name_, peer_, SerializeEnvelope(std::move(message))); }

SimulatedWorker::Tasks::iterator SimulatedWorker::Find(LeaseId lease) {
  return std::ranges::find_if(tasks_, [lease](const Running& task) { return task.lease == lease; });
}

std::optional<LeaseId> SimulatedWorker::BelievesIn(const TaskId& task, LeaseId lease) const {
  if (!alive() || hung()) return std::nullopt;
  const auto other = std::ranges::find_if(tasks_, [&](const Running& running) {
    return running.spec.id == task && !running.stopping && running.lease != lease &&
           running.lease.value() / kLeasesOfCoordinator == lease.value() / kLeasesOfCoordinator;
  });
  return other == tasks_.end() ? std::nullopt : std::optional(other->lease);
}

// ---- tasks ----

void SimulatedWorker::BeginTasks() {
  for (Running& task : tasks_) {
    if (std::ranges::count_if(tasks_, &Running::computing) >= shape_.slots) return;
    if (task.computing || task.stopping) continue;
    task.computing = true;
    task.begun = around_.events.now();
    const std::optional<TimePoint> expiry = lifecycle_->ExpiryOf(task.lease);
    if (!expiry || *expiry <= around_.events.now()) {
      TaskOutcome outcome;
      outcome.status = {ErrorCode::kLeaseExpired, "the lease ran out before the task was begun"};
      After(Milliseconds(0), Thread::kCompute, [this, lease = task.lease, outcome] { EndTask(lease, outcome); });
      continue;
    }
    ++tasks_begun_;
    around_.begun(*this, task.lease, task.spec);
    int missing = 0;
    for (const TaskInput& input : task.spec.inputs) missing += store_.contains(input.artifact.key) ? 0 : 1;
    After(Slowly(5, 30 + 100 * missing), Thread::kCompute, [this, lease = task.lease] { FetchInputs(lease); });
  }
}

bool SimulatedWorker::Fetch(const TaskInput& input) {
  if (Read(input.artifact.key) != nullptr) return true;
  return std::ranges::any_of(input.locations, [&](const ArtifactLocation& location) {
    const SimulatedWorker* holder = around_.find(location.endpoint);
    if (holder == nullptr || holder == this || around_.network.IsCut(name_, holder->name()) ||
        around_.network.IsCut(holder->name(), name_)) {
      return false;
    }
    if (holder->Serve(input.artifact.key) != input.artifact.content_digest) return false;
    Store(input.artifact);
    return true;
  });
}

void SimulatedWorker::FetchInputs(LeaseId lease) {
  const auto task = Find(lease);
  if (task == tasks_.end()) return;
  TaskOutcome outcome;
  for (const TaskInput& input : task->spec.inputs) {
    if (!Fetch(input)) outcome.missing_inputs.push_back(input.artifact.key);
  }
  if (!outcome.missing_inputs.empty()) {
    outcome.status = Unavailable("inputs can be had nowhere");
    After(Slowly(100, 2000), Thread::kCompute, [this, lease, outcome] { EndTask(lease, outcome); });
    return;
  }
  const int usual = NeedsFolder(task->spec.id.kind) ? 100 : 2000 * shape_.task_length;
  After(Slowly(usual / 10, usual), Thread::kCompute, [this, lease] { Compute(lease); });
}

// Half way.
void SimulatedWorker::Compute(LeaseId lease) {
  const auto task = Find(lease);
  if (task == tasks_.end()) return;
  const TaskId& id = task->spec.id;
  const bool poison =
      task->config->sequence_name == kPoison && (id.kind == TaskKind::kEstimate || id.kind == TaskKind::kRender);
  if (poison) around_.poisoned(id);
  if (poison || around_.random.Chance(around_.faults.runs_out_of_memory)) {
    Die();
    return;
  }
  if (MakesFiles(id.kind) && !task->config->keeps_results) (void)StageFiles(*task, 1);
  After(Slowly(10, 1000 * shape_.task_length), Thread::kCompute, [this, lease] { FinishTask(lease); });
}

void SimulatedWorker::FinishTask(LeaseId lease) {
  const auto task = Find(lease);
  if (task != tasks_.end()) EndTask(lease, Execute(*task));
}

TaskOutcome SimulatedWorker::Execute(const Running& task) {
  TaskOutcome outcome;
  const TaskSpec& spec = task.spec;
  outcome.stats.wall_seconds = outcome.stats.cpu_seconds =
      std::chrono::duration<double>(around_.events.now() - task.begun).count();
  if (around_.random.Chance(around_.faults.fails)) {
    outcome.status = Internal("by chance");
    return outcome;
  }
  const bool reads_pictures = spec.id.kind == TaskKind::kAnalyse || spec.id.kind == TaskKind::kRender;
  if (reads_pictures && task.config->sequence_name == kUnreadable) {
    outcome.status = InvalidArgument(spec.picture + ": is no picture");
    return outcome;
  }
  std::optional<ArtifactKey> key = spec.output_key;
  if (spec.id.kind == TaskKind::kAnalyse) {
    key = AnalysisKeyOf(spec);
    outcome.output_key = key;
    outcome.picture_digest = PictureDigestOf(spec);
    if (spec.known && spec.known->artifact.key == *key) (void)Fetch(*spec.known);
  }
  if (MakesFiles(spec.id.kind)) outcome.files = Describe(FilesOf(spec, *task.config));
  if (key) {
    if (const Stored* stored = Read(*key)) {
      outcome.artifact = stored->info;
      outcome.stats.reused = true;
      return outcome;
    }
    if (around_.random.Chance(around_.faults.disk_is_full)) {
      outcome.status = Unavailable("no space left on the device");
      return outcome;
    }
    outcome.artifact = ArtifactOf(spec, *key);
    Store(*outcome.artifact);
    return outcome;
  }
  outcome.status = WorkInFolder(task, outcome);
  return outcome;
}

Result<OutputFolder> SimulatedWorker::FolderOf(const Running& task) const {
  const StillLeased still_leased = [this, lease = task.lease] {
    const std::optional<TimePoint> expiry = lifecycle_->ExpiryOf(lease);
    return expiry && around_.events.now() < *expiry;
  };
  return OutputFolder::At(task.config->output_dir, task.config->render ? OutputContent::kViews : OutputContent::kDepth,
                          {task.config->claim, still_leased});
}

Status SimulatedWorker::StageFiles(const Running& task, std::size_t count) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, FolderOf(task));
  for (const MadeFile& file : FilesOf(task.spec, *task.config) | std::views::take(count))
    DEPTHFARM_RETURN_IF_ERROR(folder.Stage(task.spec.staging, file.path, file.bytes));
  return {};
}

Status SimulatedWorker::WorkInFolder(const Running& task, TaskOutcome& outcome) const {
  const TaskSpec& spec = task.spec;
  DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, FolderOf(task));
  switch (spec.id.kind) {
    case TaskKind::kPrepare:
      return spec.files.empty() ? folder.Prepare() : folder.Resume(spec.files);
    case TaskKind::kEmit:
    case TaskKind::kRender:
      return StageFiles(task, outcome.files.size());
    case TaskKind::kCommit:
      return folder.Commit(spec.staging, spec.files);
    case TaskKind::kManifest: {
      if (task.config->render) {
        DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatViewsManifest(*task.config, spec.views, spec.files));
        return folder.Finish(text);
      }
      DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest,
                                 ManifestOf(*task.config, spec.files, spec.picture_digests));
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatDepthManifest(manifest));
      return folder.Finish(text);
    }
    case TaskKind::kCleanup:
      return folder.RemoveStaging();
    default:
      return Internal(TaskName(spec.id) + ": is not simulated");
  }
}

void SimulatedWorker::StopTask(LeaseId lease) {
  const auto task = Find(lease);
  if (task == tasks_.end() || task->stopping) return;
  task->stopping = true;
  TaskOutcome outcome;
  outcome.status = Cancelled();
  // A task looks now and then whether it is stopped.
  const Milliseconds notice(task->computing ? around_.random.Int(0, 1000) : 0);
  After(notice, Thread::kCompute, [this, lease, outcome] { EndTask(lease, outcome); });
}

void SimulatedWorker::EndTask(LeaseId lease, TaskOutcome outcome) {
  const auto task = Find(lease);
  if (task == tasks_.end()) return;
  ended_ = LeasedOutcome{lease, task->spec.id, std::move(outcome)};
  tasks_.erase(task);
  Handle(event::TaskEnded{lease});
  ended_.reset();
  BeginTasks();
}

// ---- store ----

std::optional<ContentDigest> SimulatedWorker::Serve(const ArtifactKey& key) const {
  const auto stored = store_.find(key);
  if (!alive() || hung() || stored == store_.end()) return std::nullopt;
  return stored->second.content;
}

const SimulatedWorker::Stored* SimulatedWorker::Read(const ArtifactKey& key) {
  const auto stored = store_.find(key);
  if (stored == store_.end()) return nullptr;
  if (stored->second.content != stored->second.info.content_digest) {
    store_.erase(stored);
    dropped_.push_back(key);
    return nullptr;
  }
  stored->second.used = ++used_;
  return &stored->second;
}

void SimulatedWorker::Store(const ArtifactInfo& artifact) {
  store_[artifact.key] = {artifact, artifact.content_digest, false, false, ++used_};
  std::erase(dropped_, artifact.key);
  Evict();
}

void SimulatedWorker::Evict() {
  if (store_.size() <= shape_.store_bound) return;
  std::set<ArtifactKey> pinned;
  for (const Running& task : tasks_) {
    for (const TaskInput& input : task.spec.inputs) pinned.insert(input.artifact.key);
    if (task.spec.output_key) pinned.insert(*task.spec.output_key);
    if (task.spec.id.kind == TaskKind::kAnalyse) pinned.insert(AnalysisKeyOf(task.spec));
  }
  std::vector<std::pair<std::pair<int, std::uint64_t>, ArtifactKey>> order;
  for (const auto& [key, stored] : store_) {
    const int turn = stored.released ? 0 : stored.kept ? 2 : 1;
    if (!pinned.contains(key)) order.push_back({{turn, stored.used}, key});
  }
  std::ranges::sort(order);
  for (const auto& [turn, key] : order) {
    if (store_.size() <= shape_.store_bound) return;
    store_.erase(key);
    dropped_.push_back(key);
  }
}

void SimulatedWorker::DamageArtifacts(int percent) {
  for (auto& [key, stored] : store_) {
    if (around_.random.Chance(percent)) stored.content = {};
  }
}

}  // namespace depthfarm::simulation
