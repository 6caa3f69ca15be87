#include <algorithm>
#include <iterator>
#include <utility>

#include "coordinator/scheduling/fair_share.h"
#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {
Scheduler::JobRecord* Scheduler::FindJob(JobId id) {
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? nullptr : &job->second;
}

void Scheduler::On(const JobSubmitted& event) {
  const JobId id = event.job.config.job;
  JobRecord& job = jobs_[id];
  job.name = event.name;
  job.priority = event.priority;
  job.needs = {event.tags, event.job.config.algorithm_version};
  job.taken = workers_.AnyFor(job.needs);
  job.submitted = now_;
  if (event.serves_uploads) job.submitter_due = now_ + options_.submitter_silence;
  if (event.ran_before) job.at_rest = now_ + options_.lease;
  job.progress =
      std::make_unique<JobProgress>(event.job, directory_, options_.max_setbacks, event.committed, event.ran_before);
  AddNote(Note::Severity::kInfo, "job_submitted",
          {{"job", std::to_string(id.value())},
           {"name", event.name},
           {"frames", std::to_string(event.job.config.resolved.num_frames)},
           {"committed", std::to_string(event.committed.size())},
           {"views", std::to_string(event.job.config.resolved.num_views())}});
  ReleaseUnneeded(results_.Forget(id));  // of a job that goes on: it has them now
}

void Scheduler::On(const JobCancelled& event) { EndJobBadly(event.job, JobState::kCancelled, Cancelled()); }

void Scheduler::On(const SubmitterHeard& event) {
  idle_ = true;
  JobRecord* job = FindJob(event.job);
  if (job != nullptr && job->submitter_due) job->submitter_due = now_ + options_.submitter_silence;
}

void Scheduler::EndJobsWithoutSubmitter() {
  for (auto& [id, job] : jobs_) {
    if (!job.submitter_due || *job.submitter_due > now_) continue;
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(options_.submitter_silence).count();
    EndJobBadly(id, JobState::kFailed,
                Unavailable("its submitter, which serves its pictures (submit --upload), was silent for " +
                            std::to_string(seconds) + " s"));
  }
}

void Scheduler::On(const ResultsRestored& event) { ReleaseUnneeded(results_.Add(event.job, event.results)); }

void Scheduler::On(const JobForgotten& event) { ReleaseUnneeded(results_.Forget(event.job)); }

void Scheduler::TaskDone(JobRecord& job, const TaskFinished& event, const Lease& lease) {
  const std::vector<ArtifactInfo> inputs = job.progress->InputsOf(event.task);
  const Task& task = *job.progress->Find(event.task);
  const std::optional<LeaseId> other =
      task.duplicate == event.lease ? std::optional(task.lease) : task.duplicate;  // before the task is gone
  Result<bool> changed_content = job.progress->Finish(event);
  if (!changed_content.ok()) {
    AddEnd(event.lease, event.task, AttemptOutcome::kFailed, changed_content.status());
    FailAttempt(event.lease, lease, changed_content.status());
    return;
  }
  AddEnd(event.lease, event.task, event.stats.reused ? AttemptOutcome::kReused : AttemptOutcome::kDone);
  job.duplicates_won += lease.duplicate ? 1 : 0;
  // Where the last attempt failed and its duplicate did not: should the artifact be lost, there is one attempt left.
  if (Task* done = FindTask(event.task)) done->failures = std::min(done->failures, options_.max_attempts - 1);
  if (other) Overtake(*other);
  if (event.task.kind == TaskKind::kAnalyse && lease.work) analyses_.Remember(*lease.work, event.artifact->key);
  if (*changed_content) AddViolation(event.task.job, event.artifact->key, TaskName(event.task));
  // What a worker has read it holds, until it says otherwise (PROTOCOL.md).
  for (const ArtifactInfo& input : inputs) (void)directory_.Add(event.worker, input);
  AddNote(Note::Severity::kInfo, "task_done",
          {{"task", TaskName(event.task)},
           {"lease", std::to_string(event.lease.value())},
           {"worker", workers_.Find(event.worker)->name},
           {"cpu", std::to_string(event.stats.cpu_seconds)}});
  if (event.task.kind == TaskKind::kEmit && event.artifact) Add(Keep{event.worker, {event.artifact->key}});
  ReleaseArtifactsOf(job);
  if (event.task.kind == job.progress->plan().EndOfFrame()) {
    Add(FrameCommitted{event.task.job, event.task.frame, job.progress->CommittedOf(event.task.frame)});
    const int gop = job.progress->plan().GopOf(event.task.frame);
    if (!job.progress->open_gops().contains(gop)) job.homes.End(gop);
  }
  if (!job.progress->done()) return;
  EndJob(event.task.job, job.ending == JobState::kRunning ? JobState::kDone : job.ending);
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
    workers_.Revoke(lease_id);
    const Lease& lease = *workers_.FindLease(lease_id);
    Add(Revoke{lease.worker, lease_id});
    AddEnd(lease_id, lease.task, AttemptOutcome::kRevoked);
  }
  job->progress->Abandon();
  ReleaseArtifactsOf(*job);
}

bool Scheduler::IsNeeded(const ArtifactKey& key) const {
  return results_.Wants(key) ||
         std::ranges::any_of(jobs_, [&](const auto& entry) { return entry.second.progress->Needs(key); });
}

bool Scheduler::IsResult(const ArtifactKey& key) const {
  return results_.Wants(key) ||
         std::ranges::any_of(jobs_, [&](const auto& entry) { return entry.second.progress->IsResult(key); });
}

void Scheduler::ReleaseArtifactsOf(JobRecord& job) { ReleaseUnneeded(job.progress->TakeReleased()); }

void Scheduler::ReleaseUnneeded(const std::vector<ArtifactKey>& keys) {
  std::map<WorkerId, Release> by_worker;
  for (const ArtifactKey& key : keys) {
    if (IsNeeded(key)) continue;
    for (const WorkerId holder : directory_.Holders(key)) by_worker[holder].keys.push_back(key);
  }
  for (auto& [worker, release] : by_worker) {
    release.worker = worker;
    Add(std::move(release));
  }
}

bool Scheduler::HasLeases(JobId id) const { return workers_.LeasesOf(id) > 0; }

void Scheduler::ConfirmCommitted() {
  std::vector<JobId> done;
  for (auto& [id, job] : jobs_) {
    if (job.progress->confirmed() || !job.at_rest || now_ < *job.at_rest || job.ending != JobState::kRunning) continue;
    job.progress->ConfirmCommitted();
    if (job.progress->done()) done.push_back(id);
  }
  for (const JobId id : done) EndJob(id, JobState::kDone);
}

void Scheduler::AdvanceEndings() {
  std::vector<JobId> over;
  for (auto& [id, job] : jobs_) {
    if (job.ending == JobState::kRunning) continue;
    if (now_ >= job.cleanup_deadline) {
      over.push_back(id);
    } else if (!job.cleanup_started && !HasLeases(id) && (!job.at_rest || now_ >= *job.at_rest)) {
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
    Add(EndWorker{id});
  }
}

void Scheduler::UpdateTaken() {
  if (workers_seen_ == workers_.generation()) return;
  workers_seen_ = workers_.generation();
  for (auto& [id, job] : jobs_) job.taken = workers_.AnyFor(job.needs);
}

void Scheduler::OpenGops() {
  const std::size_t wanted =
      std::max<std::size_t>(1, workers_.num_slots() * static_cast<std::size_t>(options_.ready_per_slot));
  std::map<int, std::size_t> jobs_of_priority;
  for (const auto& [id, job] : jobs_) jobs_of_priority[job.priority] += job.taken ? 1 : 0;
  std::size_t ready = 0;
  for (const JobId id : JobsInFairOrder()) {
    const JobRecord& job = jobs_.at(id);
    if (!job.taken) continue;  // what is ready here, nobody takes
    JobProgress& progress = *job.progress;
    const std::size_t jobs = jobs_of_priority.at(job.priority);
    const std::size_t share = ReadyShare(wanted, jobs);
    // A GOP for each slot, so that workers need not share one.
    const std::size_t gops = ReadyShare(workers_.num_slots(), jobs);
    for (int opened = 0; opened < options_.gops_at_once && progress.HasUnopenedGop() &&
                         progress.num_open_gops() < options_.max_open_gops &&
                         (progress.table().ready().size() < share || progress.open_gops().size() < gops);
         ++opened) {
      progress.OpenNextGop();
    }
    ready += std::min(share, progress.table().ready().size());
    if (ready >= wanted) return;
  }
}

void Scheduler::EndJob(JobId id, JobState state) {
  JobRecord& job = jobs_.at(id);
  job.progress->Abandon();
  ReleaseArtifactsOf(job);
  std::vector<std::pair<LeaseId, Lease>> leases;
  for (const auto& [lease_id, lease] : workers_.leases()) {
    if (lease.task.job == id) leases.emplace_back(lease_id, lease);
  }
  for (const auto& [lease_id, lease] : leases) {
    Add(Revoke{lease.worker, lease_id});
    if (!lease.revoked) AddEnd(lease_id, lease.task, AttemptOutcome::kRevoked);
    workers_.EndLease(lease_id);
  }
  for (auto& [worker_id, worker] : workers_.workers()) {
    if (worker.told_jobs.erase(id) > 0) Add(ForgetJob{worker_id, id});
  }
  JobSnapshot snapshot = Snapshot(id, job);
  snapshot.state = state;
  snapshot.ended = now_;
  const std::vector<ArtifactKey> unwanted =
      snapshot.keeps_results ? results_.Add(id, job.progress->TakeResults()) : std::vector<ArtifactKey>();
  jobs_.erase(id);
  ReleaseUnneeded(unwanted);
  Add(JobEnded{std::move(snapshot)});
}

double Scheduler::SlotsOf(JobId id, const JobRecord& job) const {
  int slots = 0;
  for (const auto& [worker_id, worker] : workers_.workers()) slots += worker.Takes(job.needs) ? worker.slots : 0;
  const auto rivals = std::ranges::count_if(jobs_, [&](const auto& entry) {
    const auto& [other_id, other] = entry;
    return other_id != id && other.taken && other.priority >= job.priority;
  });
  return static_cast<double>(slots) / static_cast<double>(1 + rivals);
}

JobSnapshot Scheduler::Snapshot(JobId id, const JobRecord& job) const {
  JobSnapshot snapshot;
  snapshot.id = id;
  snapshot.name = job.name;
  snapshot.output_dir = job.progress->plan().job().config.output_dir;
  snapshot.keeps_results = job.progress->plan().keeps_results();
  snapshot.priority = job.priority;
  snapshot.error = job.error;
  const JobPlan& plan = job.progress->plan();
  snapshot.frames_done = plan.renders() ? job.progress->files_done() : job.progress->frames_done();
  snapshot.frames_total = plan.renders() ? static_cast<int>(plan.job().views.size()) : plan.resolved().num_frames;
  snapshot.stages = job.progress->stages();
  std::vector<TaskId> computing;
  for (const auto& [lease_id, lease] : workers_.leases()) {
    if (lease.task.job != id) continue;
    const Worker& worker = *workers_.Find(lease.worker);
    snapshot.running.push_back({lease.task, lease.worker, worker.name, lease.duplicate});
    // A worker begins its tasks in the order of their leases.
    const auto before = std::distance(worker.leases.begin(), worker.leases.find(lease_id));
    if (before < worker.slots && !lease.duplicate) computing.push_back(lease.task);
  }
  if (job.ending == JobState::kRunning)
    snapshot.seconds_left = job.progress->remaining().Seconds(SlotsOf(id, job), computing);
  snapshot.tags = job.needs.tags;
  snapshot.algorithm_version = job.needs.algorithm_version;
  snapshot.lacks_worker = !job.taken;
  snapshot.retries = job.retries;
  snapshot.duplicates = job.duplicates;
  snapshot.duplicates_won = job.duplicates_won;
  snapshot.failed_task = job.failed_task;
  snapshot.determinism_violations = job.violations;
  snapshot.submitted = job.submitted;
  return snapshot;
}

std::optional<JobSnapshot> Scheduler::Job(JobId id) const {
  const auto job = jobs_.find(id);
  if (job == jobs_.end()) return std::nullopt;
  return Snapshot(id, job->second);
}

const JobResults* Scheduler::ResultsOf(JobId id) const {
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? results_.Find(id) : &job->second.progress->results();
}

std::vector<JobSnapshot> Scheduler::Jobs() const {
  std::vector<JobSnapshot> snapshots;
  for (const auto& [id, job] : jobs_) snapshots.push_back(Snapshot(id, job));
  return snapshots;
}

void Scheduler::Advance() {
  UpdateTaken();
  ConfirmCommitted();
  AdvanceEndings();
  EndDrainedWorkers();
  OpenGops();
  Assign();
  OpenGops();  // what Assign took is not ready any more
  for (auto& [id, job] : jobs_) {
    const std::vector<int> lost = job.progress->TakeLostFrames();
    for (const int frame : lost) Add(FrameLost{id, frame});
  }
}

}  // namespace depthfarm
