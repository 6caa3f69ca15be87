// What waits behind the slots of one worker while a slot of another is idle.
#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "coordinator/scheduling/placement.h"
#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {

void Scheduler::EraseAwaited(std::vector<WorkerId>& idle_workers) const {
  for (const auto& [id, worker] : workers_.workers()) {
    for (const LeaseId lease : workers_.BehindSlots(worker)) {
      const Lease& asked = workers_.leases().at(lease);
      // Not for ever: the question or its answer may be lost.
      if (asked.asked_back_for && now_ - asked.asked_back_at < options_.lease / 2)
        std::erase(idle_workers, *asked.asked_back_for);
    }
  }
}

// Only the worker knows whether it has begun a task: what it ended may not have been heard of yet. So the lease stays
// as it is until the worker answers, and a task that it has begun it simply goes on with.
void Scheduler::Rebalance(std::vector<WorkerId> idle_workers) {
  EraseAwaited(idle_workers);
  if (idle_workers.empty()) return;
  // Each look costs a pass over the idle workers; where so many found none, the next event looks again.
  std::size_t in_vain = 0;
  std::set<JobId> nobody_takes;
  for (const LeaseId lease : LeasesToAskBack()) {
    const JobId job = workers_.leases().at(lease).task.job;
    if (nobody_takes.contains(job)) continue;
    if (WhoTakes(jobs_.at(job), idle_workers).empty()) {
      nobody_takes.insert(job);
    } else if (!AskBackFor(lease, idle_workers)) {
      ++in_vain;
    }
    if (idle_workers.empty() || in_vain == kMaxCandidates) return;
  }
}

std::vector<LeaseId> Scheduler::LeasesToAskBack() const {
  std::vector<std::pair<TaskId, LeaseId>> waiting;
  for (const auto& [id, worker] : workers_.workers()) {
    for (const LeaseId id_of_lease : workers_.BehindSlots(worker)) {
      const Lease& lease = workers_.leases().at(id_of_lease);
      if (MayBeAskedBack(id_of_lease, lease)) waiting.emplace_back(lease.task, id_of_lease);
    }
  }
  std::map<JobId, std::size_t> turn;
  if (!waiting.empty()) {
    for (const JobId id : JobsInFairOrder()) turn.emplace(id, turn.size());
  }
  std::ranges::sort(waiting, [&](const auto& a, const auto& b) {
    const std::size_t turn_a = turn.at(a.first.job);
    const std::size_t turn_b = turn.at(b.first.job);
    return turn_a != turn_b ? turn_a < turn_b : ByUrgency()(a.first, b.first);
  });
  std::vector<LeaseId> leases;
  leases.reserve(waiting.size());
  for (const auto& [task, lease] : waiting) leases.push_back(lease);
  return leases;
}

// Once for each attempt of a task.
bool Scheduler::MayBeAskedBack(LeaseId id, const Lease& lease) const {
  const Task* task = jobs_.at(lease.task.job).progress->Find(lease.task);
  return task != nullptr && task->lease == id && task->asked_back != task->failures + 1;
}

bool Scheduler::AskBackFor(LeaseId id, std::vector<WorkerId>& idle_workers) {
  Lease& lease = *workers_.FindLease(id);
  JobRecord& job = jobs_.at(lease.task.job);
  Task& task = *job.progress->Find(lease.task);
  const std::vector<WorkerId> takers = WhoTakes(job, idle_workers);
  TaskCandidate candidate = CandidateOf(job, lease.task, takers);
  LeaveToHome(job, takers, candidate);
  const std::optional<Placement> placement = ChoosePlacement({&candidate, 1}, takers);
  if (!placement) return false;
  task.asked_back = task.failures + 1;
  lease.asked_back_for = placement->worker;
  lease.asked_back_at = now_;
  std::erase(idle_workers, placement->worker);
  AddNote(Note::Severity::kInfo, "task_asked_back",
          {{"task", TaskName(lease.task)},
           {"lease", std::to_string(id.value())},
           {"worker", workers_.Find(lease.worker)->name},
           {"for", workers_.Find(placement->worker)->name}});
  Add(AskBack{lease.worker, id});
  return true;
}

}  // namespace depthfarm
