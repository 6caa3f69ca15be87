#include <algorithm>
#include <utility>

#include "coordinator/scheduling/fair_share.h"
#include "coordinator/scheduling/placement.h"
#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {
namespace {

// Locality chooses among at most so many equally urgent tasks: more would cost time and gain little.
constexpr std::size_t kMaxCandidates = 16;

}  // namespace

Scheduler::JobRecord* Scheduler::FindJob(JobId id) {
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? nullptr : &job->second;
}

void Scheduler::On(const JobSubmitted& event) {
  const JobId id = event.job.config.job;
  JobRecord& job = jobs_[id];
  job.name = event.name;
  job.priority = event.priority;
  job.tags = event.tags;
  job.submitted = now_;
  job.progress = std::make_unique<JobProgress>(event.job, directory_, options_.max_setbacks);
  AddNote(Note::Severity::kInfo, "job_submitted",
          {{"job", std::to_string(id.value())},
           {"name", event.name},
           {"frames", std::to_string(event.job.config.resolved.num_frames)},
           {"views", std::to_string(event.job.config.resolved.num_views())}});
}

void Scheduler::On(const JobCancelled& event) { EndJobBadly(event.job, JobState::kCancelled, Cancelled()); }

void Scheduler::TaskDone(JobRecord& job, const TaskFinished& event, const Lease& lease) {
  const std::vector<ArtifactInfo> inputs = job.progress->InputsOf(event.task);
  Result<bool> changed_content = job.progress->Finish(event);
  if (!changed_content.ok()) {
    CountFailure(event.task, event.worker, changed_content.status());
    return;
  }
  if (event.task.kind == TaskKind::kAnalyse && lease.work) analyses_.Remember(*lease.work, event.artifact->key);
  if (*changed_content) AddViolation(event.task.job, event.artifact->key, TaskName(event.task));
  // What a worker has read it holds, until it says otherwise (PROTOCOL.md).
  for (const ArtifactInfo& input : inputs) (void)directory_.Add(event.worker, input);
  AddNote(Note::Severity::kInfo, "task_done",
          {{"task", TaskName(event.task)},
           {"lease", std::to_string(event.lease.value())},
           {"worker", workers_.Find(event.worker)->name},
           {"cpu", std::to_string(event.stats.cpu_seconds)}});
  ReleaseArtifactsOf(job);
  if (!job.progress->done()) return;
  EndJob(event.task.job, job.ending == JobState::kRunning ? JobState::kDone : job.ending);
}

void Scheduler::CountFailure(const TaskId& id, WorkerId worker, const Status& error) {
  JobRecord* job = FindJob(id.job);
  Task* task = job == nullptr ? nullptr : job->progress->Find(id);
  if (task == nullptr || task->state != TaskState::kLeased) return;
  ++job->retries;
  ++task->failures;
  task->failed_on.insert(worker);
  if (task->failures < options_.max_attempts) {
    job->progress->PutBack(id);
    return;
  }
  const Status reason(error.code(), TaskName(id) + " failed " + std::to_string(task->failures) +
                                        " times, the last time: " + error.message());
  if (id.kind == TaskKind::kCleanup) {
    AddNote(Note::Severity::kWarning, "cleanup_failed",
            {{"job", std::to_string(id.job.value())}, {"reason", reason.message()}});
    EndJob(id.job, job->ending);
    return;
  }
  EndJobBadly(id.job, JobState::kFailed, reason);
}

void Scheduler::ForgetInputs(JobRecord& job, const TaskFailed& event, const Lease& lease) {
  std::vector<ArtifactKey> lost;
  for (const auto& [key, holders] : lease.told) {
    if (std::find(event.missing_inputs.begin(), event.missing_inputs.end(), key) == event.missing_inputs.end())
      continue;
    for (const WorkerId holder : holders) {
      if (directory_.Remove(holder, key)) lost.push_back(key);
    }
  }
  job.progress->Find(event.task)->failed_on.insert(event.worker);
  ++job.retries;
  job.progress->CountSetback(event.task);
  if (job.progress->worn_out()) {
    EndJobBadly(event.task.job, JobState::kFailed, event.error.WithContext(TaskName(event.task)));
  } else {
    job.progress->PutBack(event.task);
  }
  LoseArtifacts(lost);
}

void Scheduler::EndJobBadly(JobId id, JobState state, const Status& error) {
  JobRecord* job = FindJob(id);
  if (job == nullptr || job->ending != JobState::kRunning) return;
  job->ending = state;
  job->error = error;
  job->cleanup_deadline = now_ + options_.cleanup_grace;
  AddNote(state == JobState::kCancelled ? Note::Severity::kInfo : Note::Severity::kError,
          state == JobState::kCancelled ? "job_cancelled" : "job_failed",
          {{"job", std::to_string(id.value())}, {"reason", error.message()}});
  std::vector<LeaseId> leases;
  for (const auto& [lease_id, lease] : workers_.leases()) {
    if (lease.task.job == id && !lease.revoked) leases.push_back(lease_id);
  }
  for (const LeaseId lease_id : leases) {
    Lease& lease = *workers_.FindLease(lease_id);
    lease.revoked = true;
    actions_.emplace_back(Revoke{lease.worker, lease_id});
  }
  job->progress->Abandon();
  ReleaseArtifactsOf(*job);
}

void Scheduler::ReleaseArtifactsOf(JobRecord& job) {
  std::map<WorkerId, std::vector<ArtifactKey>> by_worker;
  for (const ArtifactKey& key : job.progress->TakeReleased()) {
    const bool needed =
        std::any_of(jobs_.begin(), jobs_.end(), [&](const auto& entry) { return entry.second.progress->Needs(key); });
    if (needed) continue;
    for (const WorkerId holder : directory_.Holders(key)) by_worker[holder].push_back(key);
  }
  for (auto& [worker, keys] : by_worker) actions_.emplace_back(Release{worker, std::move(keys)});
}

bool Scheduler::HasLeases(JobId id) const { return workers_.LeasesOf(id) > 0; }

void Scheduler::AdvanceEndings() {
  std::vector<JobId> over;
  for (auto& [id, job] : jobs_) {
    if (job.ending == JobState::kRunning) continue;
    if (now_ >= job.cleanup_deadline) {
      over.push_back(id);
    } else if (!job.cleanup_started && !HasLeases(id)) {
      // Not before its last task has stopped: that one could still write into the folder.
      if (job.progress->prepare_was_granted()) {
        job.progress->StartCleanup();
        job.cleanup_started = true;
      } else {
        over.push_back(id);
      }
    }
  }
  for (const JobId id : over) EndJob(id, jobs_.at(id).ending);
}

void Scheduler::EndDrainedWorkers() {
  for (auto& [id, worker] : workers_.workers()) {
    if (!worker.draining || worker.told_to_end || !worker.leases.empty()) continue;
    worker.told_to_end = true;
    actions_.emplace_back(EndWorker{id});
  }
}

void Scheduler::OpenGops() {
  const std::size_t wanted =
      std::max<std::size_t>(1, workers_.num_slots() * static_cast<std::size_t>(options_.ready_per_slot));
  std::map<int, std::size_t> jobs_of_priority;
  for (const auto& [id, job] : jobs_) jobs_of_priority[job.priority] += workers_.AnyFor(job.tags) ? 1 : 0;
  std::size_t ready = 0;
  for (const JobId id : JobsInFairOrder()) {
    const JobRecord& job = jobs_.at(id);
    if (!workers_.AnyFor(job.tags)) continue;  // what is ready here, nobody takes
    JobProgress& progress = *job.progress;
    const std::size_t share = ReadyShare(wanted, jobs_of_priority.at(job.priority));
    while (progress.table().ready().size() < share && progress.HasUnopenedGop() &&
           progress.num_open_gops() < options_.max_open_gops) {
      progress.OpenNextGop();
    }
    ready += std::min(share, progress.table().ready().size());
    if (ready >= wanted) return;
  }
}

std::vector<WorkerId> Scheduler::WorkersWith(WorkerTable::Room room) const {
  std::vector<std::pair<TimePoint, WorkerId>> free;
  for (const auto& [id, worker] : workers_.workers()) {
    // A worker refuses a grant for an ask older than half a lease.
    if (workers_.RoomOf(worker, now_, options_.lease / 2) == room) free.emplace_back(worker.ask->received, id);
  }
  std::sort(free.begin(), free.end());
  std::vector<WorkerId> ids;
  ids.reserve(free.size());
  for (const auto& [received, id] : free) ids.push_back(id);
  return ids;
}

void Scheduler::Assign() {
  std::vector<WorkerId> free_workers = WorkersWith(WorkerTable::Room::kSlot);
  while (!free_workers.empty() && AssignNext(free_workers)) {
  }
  // Ahead only while enough is left for whoever is free next: a task that waits behind another one would end later than
  // on a worker that idles meanwhile.
  std::vector<WorkerId> fetching = WorkersWith(WorkerTable::Room::kAhead);
  const std::size_t reserve = workers_.num_slots();
  while (!fetching.empty() && NumReady() > reserve && AssignNext(fetching)) {
  }
}

std::size_t Scheduler::NumReady() const {
  std::size_t ready = 0;
  for (const auto& [id, job] : jobs_) ready += workers_.AnyFor(job.tags) ? job.progress->table().ready().size() : 0;
  return ready;
}

bool Scheduler::AssignNext(std::vector<WorkerId>& free_workers) {
  const std::vector<JobId> order = JobsInFairOrder();
  return std::ranges::any_of(order, [&](JobId id) { return AssignOneOf(jobs_.at(id), free_workers); });
}

std::vector<JobId> Scheduler::JobsInFairOrder() const {
  std::vector<JobShare> shares;
  shares.reserve(jobs_.size());
  for (const auto& [id, job] : jobs_) shares.push_back({id, job.priority, workers_.LeasesOf(id), job.last_grant});
  return FairOrder(std::move(shares));
}

std::optional<ArtifactInfo> Scheduler::HintOf(const JobRecord& job, const TaskId& task) const {
  if (task.kind != TaskKind::kAnalyse) return std::nullopt;
  const std::optional<ArtifactKey> made = analyses_.Find(job.progress->WorkOf(task).value());
  const ArtifactInfo* artifact = made ? directory_.Find(*made) : nullptr;
  return artifact == nullptr ? std::nullopt : std::optional(*artifact);
}

std::vector<ArtifactInfo> Scheduler::InputsOrHint(const JobRecord& job, const TaskId& task) const {
  std::vector<ArtifactInfo> inputs = job.progress->InputsOf(task);
  if (const std::optional<ArtifactInfo> hint = HintOf(job, task)) inputs.push_back(*hint);
  return inputs;
}

TaskCandidate Scheduler::CandidateOf(JobRecord& job, const TaskId& task) const {
  TaskCandidate candidate{task, {}, {}};
  for (const ArtifactInfo& input : InputsOrHint(job, task)) {
    for (const WorkerId holder : directory_.Holders(input.key)) candidate.local_bytes[holder] += input.stored_bytes;
  }
  const std::set<WorkerId>& failed_on = job.progress->Find(task)->failed_on;
  const std::uint64_t memory = job.progress->MemoryOf(task);
  const auto is_large = [&](const Worker& worker) { return worker.memory_bytes == 0 || worker.memory_bytes >= memory; };
  const bool large_exist = std::ranges::any_of(
      workers_.workers(), [&](const auto& entry) { return entry.second.Takes(job.tags) && is_large(entry.second); });
  const auto takes = [&](const Worker& worker) { return worker.Takes(job.tags) && (is_large(worker) || !large_exist); };
  const bool others = std::ranges::any_of(
      workers_.workers(), [&](const auto& entry) { return takes(entry.second) && !failed_on.contains(entry.first); });
  for (const auto& [id, worker] : workers_.workers()) {
    if (!takes(worker) || (others && failed_on.contains(id))) {
      candidate.avoid.insert(id);
    } else if (large_exist ? !workers_.HasMemory(worker, memory) : !workers_.IsEmpty(worker)) {
      candidate.full.insert(id);
    }
  }
  return candidate;
}

bool Scheduler::AssignOneOf(JobRecord& job, std::vector<WorkerId>& free_workers) {
  const auto& ready = job.progress->table().ready();
  for (auto first = ready.begin(); first != ready.end();) {
    std::vector<TaskCandidate> candidates;
    auto next = first;
    for (; next != ready.end() && EquallyUrgent(*next, *first); ++next) {
      if (candidates.size() == kMaxCandidates) continue;
      // What another task makes just now is not made twice: this one is done without running when that one is.
      const std::optional<ArtifactKey> work = job.progress->WorkOf(*next);
      if (work && workers_.IsUnderWay(*work)) continue;
      candidates.push_back(CandidateOf(job, *next));
    }
    if (const std::optional<Placement> placement = ChoosePlacement(candidates, free_workers)) {
      const std::size_t leases = workers_.leases().size();
      MakeGrant(job, *placement);
      if (workers_.leases().size() > leases) std::erase(free_workers, placement->worker);
      return true;
    }
    HoldForMemory(candidates, free_workers);
    first = next;
  }
  return false;
}

void Scheduler::HoldForMemory(const std::vector<TaskCandidate>& candidates, std::vector<WorkerId>& free_workers) {
  for (const TaskCandidate& candidate : candidates) {
    const auto full = std::ranges::find_if(free_workers, [&](WorkerId id) { return candidate.full.contains(id); });
    if (full == free_workers.end()) continue;
    free_workers.erase(full);
    return;
  }
}

void Scheduler::MakeGrant(JobRecord& job, const Placement& placement) {
  const LeaseId lease_id(next_lease_);
  std::optional<GrantedTask> task = job.progress->Take(placement.task, lease_id);
  if (!task) return;  // its inputs are gone, or its artifact is there already
  ++next_lease_;
  job.last_grant = lease_id.value();
  Worker& worker = *workers_.Find(placement.worker);
  if (const std::optional<ArtifactInfo> hint = HintOf(job, placement.task)) {
    task->spec.known = TaskInput{*hint, InputRole::kAnalysis, placement.task.index, {}};
    task->holders_of_known = HoldersToTell(directory_, hint->key, lease_id);
  }
  Lease& lease = workers_.AddLease(lease_id, {.task = placement.task,
                                              .worker = worker.id,
                                              .expires = now_ + options_.lease,
                                              .told = {},
                                              .work = job.progress->WorkOf(placement.task),
                                              .memory_bytes = job.progress->MemoryOf(placement.task)});
  for (std::size_t i = 0; i < task->spec.inputs.size(); ++i) {
    lease.told.emplace_back(task->spec.inputs[i].artifact.key, task->holders[i]);
  }
  const int attempt = job.progress->Find(placement.task)->failures + 1;
  const bool first_of_job = worker.known_jobs.insert(placement.task.job).second;
  AddNote(Note::Severity::kInfo, "task_granted",
          {{"task", TaskName(placement.task)},
           {"lease", std::to_string(lease_id.value())},
           {"worker", worker.name},
           {"attempt", std::to_string(attempt)}});
  actions_.emplace_back(Grant{worker.id, lease_id, worker.ask->id, attempt, first_of_job, std::move(*task)});
  worker.ask.reset();
}

void Scheduler::EndJob(JobId id, JobState state) {
  JobRecord& job = jobs_.at(id);
  job.progress->Abandon();
  ReleaseArtifactsOf(job);
  std::vector<std::pair<LeaseId, WorkerId>> leases;
  for (const auto& [lease_id, lease] : workers_.leases()) {
    if (lease.task.job == id) leases.emplace_back(lease_id, lease.worker);
  }
  for (const auto& [lease_id, worker] : leases) {
    actions_.emplace_back(Revoke{worker, lease_id});
    workers_.EndLease(lease_id);
  }
  for (auto& [worker_id, worker] : workers_.workers()) {
    if (worker.known_jobs.erase(id) > 0) actions_.emplace_back(ForgetJob{worker_id, id});
  }
  JobSnapshot snapshot = Snapshot(id, job);
  snapshot.state = state;
  snapshot.ended = now_;
  jobs_.erase(id);
  actions_.emplace_back(JobEnded{std::move(snapshot)});
}

JobSnapshot Scheduler::Snapshot(JobId id, const JobRecord& job) const {
  JobSnapshot snapshot;
  snapshot.id = id;
  snapshot.name = job.name;
  snapshot.output_dir = job.progress->plan().job().config.output_dir;
  snapshot.priority = job.priority;
  snapshot.error = job.error;
  const JobPlan& plan = job.progress->plan();
  snapshot.frames_done = plan.renders() ? job.progress->files_done() : job.progress->frames_done();
  snapshot.frames_total = plan.renders() ? static_cast<int>(plan.job().views.size()) : plan.resolved().num_frames;
  snapshot.stages = job.progress->stages();
  for (const auto& [lease_id, lease] : workers_.leases()) {
    if (lease.task.job == id) snapshot.running.push_back({lease.task, lease.worker, workers_.Find(lease.worker)->name});
  }
  snapshot.tags = job.tags;
  snapshot.lacks_worker = !workers_.AnyFor(job.tags);
  snapshot.retries = job.retries;
  snapshot.determinism_violations = job.violations;
  snapshot.submitted = job.submitted;
  return snapshot;
}

std::optional<JobSnapshot> Scheduler::Job(JobId id) const {
  const auto job = jobs_.find(id);
  if (job == jobs_.end()) return std::nullopt;
  return Snapshot(id, job->second);
}

std::vector<JobSnapshot> Scheduler::Jobs() const {
  std::vector<JobSnapshot> snapshots;
  for (const auto& [id, job] : jobs_) snapshots.push_back(Snapshot(id, job));
  return snapshots;
}

void Scheduler::Advance() {
  AdvanceEndings();
  EndDrainedWorkers();
  OpenGops();
  Assign();
  OpenGops();  // what Assign took is not ready any more
}

}  // namespace depthfarm
