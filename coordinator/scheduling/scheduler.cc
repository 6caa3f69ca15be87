#include "coordinator/scheduling/scheduler.h"

#include <algorithm>
#include <set>
#include <utility>

namespace depthfarm {
namespace {

std::string Number(std::uint64_t value) { return std::to_string(value); }

}  // namespace

Scheduler::Scheduler(const SchedulerOptions& options) : options_(options), next_lease_(options.first_lease) {}

std::vector<Action> Scheduler::Handle(const Event& event, TimePoint now) {
  now_ = now;
  idle_ = false;
  std::visit([this](const auto& typed) { On(typed); }, event);
  if (!idle_) Advance();
  return std::exchange(actions_, {});
}

std::vector<Action> Scheduler::Tick(TimePoint now) {
  now_ = now;
  std::vector<WorkerId> silent;
  for (const auto& [id, worker] : workers_.workers()) {
    if (now - worker.last_heard >= options_.lease) silent.push_back(id);
  }
  for (const WorkerId id : silent) {
    const Loss lost{.reason = Unavailable("the worker was lost")};
    RemoveWorker(*workers_.Find(id), &lost);
  }
  EndJobsWithoutSubmitter();
  std::vector<LeaseId> overdue;
  for (const auto& [id, lease] : workers_.leases()) {
    if (lease.expires <= now) overdue.push_back(id);
  }
  for (const LeaseId id : overdue) {
    if (workers_.FindLease(id) == nullptr) continue;
    const Lease lease = *workers_.FindLease(id);
    workers_.EndLease(id);
    if (lease.revoked) continue;  // maybe since one before it failed their job
    AddNote(Note::Severity::kWarning, "lease_expired",
            {{"task", TaskName(lease.task)}, {"lease", Number(id.value())}, {"worker", Number(lease.worker.value())}});
    Add(Revoke{lease.worker, id});
    // Of a worker that died right after the grant the lease ends before its silence is noticed.
    const Status reason =
        Status(ErrorCode::kLeaseExpired, "the lease ran out").WithContext(workers_.Find(lease.worker)->name);
    AddEnd(id, lease.task, AttemptOutcome::kExpired, reason);
    FailAttempt(id, lease, reason, true);
  }
  Advance();
  workers_.MarkBegun(now_);
  GrantDuplicates();
  return std::exchange(actions_, {});
}

void Scheduler::On(const WorkerJoined& event) {
  if (const Worker* before = workers_.Find(event.worker); before != nullptr && event.restarted) {
    const Loss died{.reason = Unavailable("the worker died and was started again")};
    EndLeasesOf(*before, &died);
  }
  Worker& worker = workers_.Join(event, now_);
  AddNote(
      Note::Severity::kInfo, "worker_joined",
      {{"worker", Number(event.worker.value())}, {"name", event.name}, {"artifacts", Number(event.artifacts.size())}});
  const std::set<LeaseId> running(event.running.begin(), event.running.end());
  const std::set<LeaseId> leases = worker.leases;
  for (const LeaseId id : leases) {
    Lease& lease = *workers_.FindLease(id);
    if (running.contains(id)) {
      if (!lease.revoked) lease.expires = now_ + options_.lease;
      continue;
    }
    const Lease ended = lease;
    workers_.EndLease(id);
    if (ended.revoked) continue;
    AddEnd(id, ended.task, AttemptOutcome::kGivenBack);
    GiveBack(id, ended.task);  // the grant never arrived
  }
  for (const LeaseId id : running) {
    const Lease* lease = worker.leases.contains(id) ? workers_.FindLease(id) : nullptr;
    if (lease == nullptr || lease->revoked) Add(Revoke{event.worker, id});
  }

  std::set<ArtifactKey> held;
  for (const ArtifactInfo& artifact : event.artifacts) held.insert(artifact.key);
  std::vector<ArtifactKey> lost;
  for (const ArtifactKey& key : directory_.KeysOf(event.worker)) {
    if (!held.contains(key) && directory_.Remove(event.worker, key)) lost.push_back(key);
  }
  for (const ArtifactInfo& artifact : event.artifacts)
    AddArtifact(event.worker, artifact, JobId(), "the store of " + event.name);
  Keep results{event.worker, {}};  // it may have been started anew
  for (const ArtifactInfo& artifact : event.artifacts) {
    if (IsResult(artifact.key)) results.keys.push_back(artifact.key);
  }
  if (!results.keys.empty()) Add(std::move(results));
  LoseArtifacts(lost);
}

bool Scheduler::NoteRunning(const Worker& worker, const std::vector<LeaseId>& running, std::uint64_t id,
                            std::uint64_t Lease::*named_by) {
  bool ended = false;
  const std::set<LeaseId> leases = worker.leases;
  for (const LeaseId lease_id : leases) {
    Lease& lease = *workers_.FindLease(lease_id);
    std::uint64_t& named = lease.*named_by;
    if (std::ranges::find(running, lease_id) != running.end()) {
      named = std::max(named, id);
    } else if (lease.revoked && named > 0 && named < id) {
      workers_.EndLease(lease_id);
      ended = true;
    }
  }
  return ended;
}

void Scheduler::On(const WorkerAsked& event) {
  Worker* worker = workers_.Find(event.worker);
  if (worker == nullptr) return;
  worker->last_heard = now_;
  worker->ask = Worker::Ask{event.ask_id, now_};
  (void)NoteRunning(*worker, event.running, event.ask_id, &Lease::named_by_ask);
}

void Scheduler::On(const WorkerHeard& event) {
  Worker* worker = workers_.Find(event.worker);
  if (worker == nullptr) return;
  worker->last_heard = now_;
  AcknowledgeHeartbeat answer{event.worker, event.heartbeat_id, {}};
  for (const LeaseId id : event.running) {
    Lease* lease = workers_.FindLease(id);
    if (lease == nullptr || lease->worker != event.worker || lease->revoked) {
      answer.unknown.push_back(id);
    } else {
      lease->expires = now_ + options_.lease;
    }
  }
  idle_ = !NoteRunning(*worker, event.running, event.heartbeat_id, &Lease::named_by_heartbeat);
  Add(std::move(answer));
}

std::optional<Lease> Scheduler::EndLeaseOf(WorkerId worker, LeaseId id, const TaskId& task) {
  const Lease* lease = workers_.FindLease(id);
  if (lease == nullptr || lease->worker != worker || lease->task != task) {
    ++late_results_;
    AddNote(Note::Severity::kWarning, "late_result",
            {{"task", TaskName(task)}, {"lease", Number(id.value())}, {"worker", Number(worker.value())}});
    return std::nullopt;
  }
  const Lease ended = *lease;
  workers_.EndLease(id);
  if (ended.revoked) return std::nullopt;
  return ended;
}

void Scheduler::On(const TaskFinished& event) {
  Worker* worker = workers_.Find(event.worker);
  if (worker == nullptr) return;
  worker->last_heard = now_;
  // Whosever result it is, the artifact is there now.
  if (event.artifact) AddArtifact(event.worker, *event.artifact, event.task.job, TaskName(event.task));
  const std::optional<Lease> lease = EndLeaseOf(event.worker, event.lease, event.task);
  if (!lease) return;
  JobRecord* job = FindJob(event.task.job);
  const Task* task = FindTask(event.task);
  // Its frame was committed meanwhile, and then maybe lost and begun anew: whose lease that is, his is the result.
  if (task == nullptr || !task->IsLeasedBy(event.lease)) {
    AddEnd(event.lease, event.task, AttemptOutcome::kDone);
    return;
  }
  ++worker->tasks_done;
  TaskDone(*job, event, *lease);
}

void Scheduler::On(const TaskFailed& event) {
  Worker* worker = workers_.Find(event.worker);
  if (worker == nullptr) return;
  worker->last_heard = now_;
  const ErrorCode code = event.error.code();
  // It was told to stop by a Revoke for a lease that is over here already: no result, and nothing that anybody awaits.
  if (code == ErrorCode::kCancelled && workers_.FindLease(event.lease) == nullptr) return;
  const std::optional<Lease> lease = EndLeaseOf(event.worker, event.lease, event.task);
  if (!lease) return;
  const bool given_back = code == ErrorCode::kLeaseExpired || code == ErrorCode::kCancelled;
  const auto told = worker->told_jobs.find(event.task.job);
  if (code == ErrorCode::kLeaseExpired && told != worker->told_jobs.end())
    told->second = false;  // that may be why: it is told again
  AddEnd(event.lease, event.task, given_back ? AttemptOutcome::kGivenBack : AttemptOutcome::kFailed, event.error);
  JobRecord* job = FindJob(event.task.job);
  if (job == nullptr || job->progress->Find(event.task) == nullptr) return;
  const bool asked_back = given_back && lease->asked_back_for.has_value();
  AddNote(asked_back ? Note::Severity::kInfo : Note::Severity::kWarning, asked_back ? "task_given_back" : "task_failed",
          {{"task", TaskName(event.task)},
           {"lease", Number(event.lease.value())},
           {"worker", worker->name},
           {"code", std::string(ErrorCodeName(code))},
           {"reason", event.error.message()}});
  if (given_back) {
    GiveBack(event.lease, event.task);  // not begun, or given up by a worker that leaves: nobody's failure
  } else if (code == ErrorCode::kInvalidArgument && event.task.kind != TaskKind::kCleanup) {
    job->failed_task = event.task;
    EndJobBadly(event.task.job, JobState::kFailed, event.error.WithContext(TaskName(event.task)));
  } else if (!event.missing_inputs.empty()) {
    ForgetInputs(*job, event, *lease);
  } else {
    FailAttempt(event.lease, *lease, event.error);
  }
}

void Scheduler::On(const ArtifactsDropped& event) {
  Worker* worker = workers_.Find(event.worker);
  if (worker == nullptr) return;
  worker->last_heard = now_;
  std::vector<ArtifactKey> lost;
  for (const ArtifactKey& key : event.keys) {
    if (directory_.Remove(event.worker, key)) lost.push_back(key);
  }
  LoseArtifacts(lost);
}

void Scheduler::On(const WorkerDrained& event) {
  Worker* worker = workers_.Find(event.worker);
  if (worker == nullptr || worker->draining) return;
  workers_.Drain(event.worker);
  for (auto& [id, job] : jobs_) job.homes.Forget(event.worker);
  AddNote(Note::Severity::kInfo, "worker_drained", {{"worker", Number(event.worker.value())}, {"name", worker->name}});
}

void Scheduler::On(const WorkerLeft& event) {
  if (Worker* worker = workers_.Find(event.worker)) RemoveWorker(*worker, nullptr);
}

void Scheduler::On(const WorkerDied& event) {
  const Loss died{Unavailable("the worker " + event.how), event.computing, event.last_words};
  if (Worker* worker = workers_.Find(event.worker)) RemoveWorker(*worker, &died);
}

void Scheduler::RemoveWorker(Worker& worker, const Loss* lost) {
  const WorkerId id = worker.id;
  const std::string name = worker.name;
  for (auto& [job_id, job] : jobs_) job.homes.Forget(id);
  if (lost == nullptr) {
    AddNote(Note::Severity::kInfo, "worker_left", {{"worker", Number(id.value())}, {"name", name}});
  } else {
    AddNote(Note::Severity::kWarning, "worker_lost",
            {{"worker", Number(id.value())}, {"name", name}, {"reason", lost->reason.message()}});
    Add(WorkerLost{id, name});
  }
  LoseArtifacts(directory_.RemoveWorker(id));
  EndLeasesOf(worker, lost);
  workers_.Remove(id);
}

void Scheduler::AddArtifact(WorkerId worker, const ArtifactInfo& artifact, JobId job, const std::string& made_by) {
  if (directory_.Add(worker, artifact) == ArtifactDirectory::AddResult::kConflict)
    AddViolation(job, artifact.key, made_by);
}

void Scheduler::AddViolation(JobId job, const ArtifactKey& key, const std::string& made_by) {
  if (JobRecord* record = FindJob(job)) ++record->violations;
  std::string hex;
  for (std::size_t i = 0; i < 8; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    hex += kDigits[key[i] >> 4U];
    hex += kDigits[key[i] & 15U];
  }
  AddNote(Note::Severity::kError, "determinism_violation", {{"key", hex}, {"made_by", made_by}});
}

void Scheduler::LoseArtifacts(const std::vector<ArtifactKey>& keys) {
  if (keys.empty()) return;
  std::vector<TaskId> worn_out;
  for (auto& [id, job] : jobs_) {
    job.progress->LoseArtifacts(keys);
    if (job.progress->worn_out()) worn_out.push_back(*job.progress->worn_out());
  }
  for (const TaskId& task : worn_out) {
    EndJobBadly(task.job, JobState::kFailed,
                Unavailable(TaskName(task) + ": its artifact or inputs were lost more than " +
                            std::to_string(options_.max_setbacks) + " times: are the workers' stores large enough?"));
  }
}

std::optional<JobId> Scheduler::JobWritingTo(const std::string& output_dir) const {
  for (const auto& [id, job] : jobs_) {
    const JobConfig& config = job.progress->plan().job().config;
    if (!config.keeps_results && config.output_dir == output_dir) return id;
  }
  return std::nullopt;
}

bool Scheduler::IsDuplicate(LeaseId lease) const {
  const auto found = workers_.leases().find(lease);
  return found != workers_.leases().end() && found->second.duplicate;
}

bool Scheduler::empty() const {
  return jobs_.empty() && workers_.workers().empty() && workers_.leases().empty() && directory_.empty();
}

std::vector<WorkerSnapshot> Scheduler::Workers() const {
  std::vector<WorkerSnapshot> snapshots;
  for (const auto& [id, worker] : workers_.workers()) {
    WorkerSnapshot snapshot;
    snapshot.id = id;
    snapshot.name = worker.name;
    snapshot.slots = worker.slots;
    snapshot.draining = worker.draining;
    snapshot.tags = worker.tags;
    snapshot.algorithm_version = worker.algorithm_version;
    snapshot.last_heard = worker.last_heard;
    snapshot.tasks_done = worker.tasks_done;
    snapshot.artifacts = directory_.Count(id);
    snapshot.artifact_bytes = directory_.Bytes(id);
    for (const LeaseId lease : worker.leases) snapshot.running.push_back(workers_.leases().at(lease).task);
    snapshots.push_back(std::move(snapshot));
  }
  return snapshots;
}

Backlog Scheduler::CountBacklog(const std::function<bool(const JobRecord&)>& counts) const {
  Backlog backlog;
  for (const auto& [id, job] : jobs_) {
    if (!counts(job)) continue;
    backlog.ready += job.progress->table().ready().size();
    backlog.unopened_gops += static_cast<std::uint64_t>(job.progress->num_unopened_gops());
  }
  for (const auto& [id, lease] : workers_.leases()) {
    const auto job = jobs_.find(lease.task.job);
    // A task that two workers have wants one slot.
    if (!lease.revoked && !lease.duplicate && job != jobs_.end() && counts(job->second)) ++backlog.leased;
  }
  return backlog;
}

Backlog Scheduler::BacklogOf(const std::set<std::string>& tags) const {
  return CountBacklog([&tags](const JobRecord& job) { return std::ranges::includes(tags, job.needs.tags); });
}

Backlog Scheduler::TotalBacklog() const {
  return CountBacklog([](const JobRecord&) { return true; });
}

void Scheduler::Add(Action action) { actions_.push_back(std::move(action)); }

void Scheduler::AddEnd(LeaseId lease, const TaskId& task, AttemptOutcome outcome, const Status& error) {
  Add(AttemptEnded{lease, task, outcome, error});
}

void Scheduler::AddNote(Note::Severity severity, std::string event,
                        std::vector<std::pair<std::string, std::string>> fields) {
  Add(Note{severity, std::move(event), std::move(fields)});
}

}  // namespace depthfarm
