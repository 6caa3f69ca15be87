// What becomes of a task whose attempt ended without a result. A task that fails again and again, or kills who computes
// it, ends its job and nothing else: its attempts are bounded, each after a longer pause and on another worker if there
// is one, and what several workers were lost with is tried alone, so that it takes no other task with it.
#include <algorithm>
#include <utility>

#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {

Task* Scheduler::FindTask(const TaskId& id) {
  JobRecord* job = FindJob(id.job);
  return job == nullptr ? nullptr : job->progress->Find(id);
}

void Scheduler::GiveBack(LeaseId id, const TaskId& task_id) {
  Task* task = FindTask(task_id);
  if (task == nullptr || !task->IsLeasedBy(id) || task->GoesOnWithout(id)) return;
  TryAgain(task_id);
}

bool Scheduler::IsTriedAlone(const Task& task) const {
  return task.deaths > 0 && task.deaths >= options_.max_attempts / 2;
}

void Scheduler::FailAttempt(LeaseId id, const Lease& lease, const Status& error, bool died) {
  const TaskId task_id = lease.task;
  JobRecord* job = FindJob(task_id.job);
  Task* task = FindTask(task_id);
  if (task == nullptr || !task->IsLeasedBy(id)) return;
  task->failed_on.insert(lease.worker);
  const bool goes_on = task->GoesOnWithout(id);
  if (!lease.duplicate) {  // which nobody asked for: its end is no failure of the task
    ++job->retries;
    ++task->failures;
    task->deaths += died ? 1 : 0;
    // The silence of the dead was pause enough.
    const int doublings = std::min(task->failures - 1, 20);
    const Milliseconds pause = std::min(options_.longest_retry_pause, options_.retry_pause * (1 << doublings));
    if (!died) job->resting[task_id] = now_ + pause;
  }
  task->last_failure = error;
  if (!goes_on) TryAgain(task_id);
}

void Scheduler::TryAgain(const TaskId& id) {
  JobRecord& job = *FindJob(id.job);
  const Task& task = *job.progress->Find(id);
  if (task.failures < options_.max_attempts) {
    job.progress->PutBack(id);
    return;
  }
  const Status reason(task.last_failure.code(), TaskName(id) + " failed " + std::to_string(task.failures) +
                                                    " times, the last time: " + task.last_failure.message());
  if (id.kind == TaskKind::kCleanup) {
    AddNote(Note::Severity::kWarning, "cleanup_failed",
            {{"job", std::to_string(id.job.value())}, {"reason", reason.message()}});
    EndJob(id.job, job.ending);
    return;
  }
  job.failed_task = id;
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
  Task& task = *job.progress->Find(event.task);
  if (task.IsLeasedBy(event.lease) && !task.GoesOnWithout(event.lease)) {
    task.failed_on.insert(event.worker);
    ++job.retries;
    job.progress->CountSetback(event.task);
    if (job.progress->worn_out()) {
      job.failed_task = event.task;
      EndJobBadly(event.task.job, JobState::kFailed, event.error.WithContext(TaskName(event.task)));
    } else {
      TryAgain(event.task);
    }
  }
  LoseArtifacts(lost);
}

void Scheduler::EndLeasesOf(const Worker& worker, const Loss* lost) {
  const std::string name = worker.name;
  const int slots = worker.slots;
  std::vector<std::pair<LeaseId, Lease>> ended;
  for (const LeaseId id : worker.leases) ended.emplace_back(id, workers_.leases().at(id));
  for (const auto& [id, lease] : ended) workers_.EndLease(id);
  // A worker begins its tasks in the order of their leases: those behind its slots can't be what killed it. But the
  // result of one may not have been sent when it died, so that it had begun the next one.
  int begun = 0;
  for (const auto& [id, lease] : ended) {
    if (lease.revoked) continue;
    const auto on_slot = [&, lease = id] {
      if (lost->computing.empty()) return begun++ < slots;
      return std::ranges::find(lost->computing, lease) != lost->computing.end();
    };
    if (lost != nullptr && on_slot()) {
      const Status reason = lost->reason.WithContext(name);
      Add(AttemptEnded{id, lease.task, AttemptOutcome::kWorkerLost, reason, lost->last_words});
      FailAttempt(id, lease, reason, true);
    } else {
      AddEnd(id, lease.task, AttemptOutcome::kGivenBack);
      GiveBack(id, lease.task);
    }
  }
}

}  // namespace depthfarm
