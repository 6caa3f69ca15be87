#include "tests/simulation/simulated_worker.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "common/wire/job_wire.h"
#include "common/wire/task_wire.h"

namespace depthfarm::simulation {
namespace {

namespace event = lifecycle_event;
namespace action = lifecycle_action;

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

std::optional<TaskId> SimulatedWorker::WorksFor(JobId job, LeaseId lease) const {
  if (!alive() || hung()) return std::nullopt;
  const auto task = std::ranges::find_if(tasks_, [&](const Running& running) {
    return running.spec.id.job == job && !running.stopping && running.lease != lease &&
           running.lease.value() / kLeasesOfCoordinator == lease.value() / kLeasesOfCoordinator;
  });
  return task == tasks_.end() ? std::nullopt : std::optional(task->spec.id);
}

}  // namespace depthfarm::simulation
