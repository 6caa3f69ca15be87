// What takes too long on one worker while another one has nothing to do: granted to that one, too. The first result
// counts, the other attempt is revoked; both would be the same bytes.
#include <algorithm>
#include <chrono>
#include <utility>

#include "coordinator/scheduling/placement.h"
#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {

// With each tick, not with each event: tasks that take too long do so for seconds.
void Scheduler::GrantDuplicates() {
  if (!options_.duplicates) return;
  std::vector<WorkerId> idle_workers = WorkersWith(WorkerTable::Room::kSlot);
  EraseAwaited(idle_workers);
  if (idle_workers.empty()) return;
  // A host that makes all its tasks late may not keep all others busy with them.
  std::size_t room = (workers_.num_slots() + 3) / 4;
  std::vector<LeaseId> late;
  for (const auto& [id, lease] : workers_.leases()) {
    if (lease.duplicate && !lease.revoked) room -= std::min<std::size_t>(room, 1);
    if (TakesTooLong(id, lease)) late.push_back(id);
  }
  for (const LeaseId id : late) {
    if (room == 0 || idle_workers.empty()) return;
    room -= GrantAgain(workers_.leases().at(id), idle_workers) ? 1 : 0;
  }
}

bool Scheduler::TakesTooLong(LeaseId id, const Lease& lease) const {
  if (lease.revoked || lease.duplicate || !lease.begun || now_ - *lease.begun < options_.straggler_least) return false;
  const JobRecord& job = jobs_.at(lease.task.job);
  const Task* task = job.progress->table().Find(lease.task);
  // What may kill its worker is not given to a second one.
  if (task == nullptr || !task->IsLeasedBy(id) || task->was_duplicated || task->deaths > 0) return false;
  const std::optional<double> expected = job.progress->remaining().SecondsOf(lease.task);
  const double seconds = std::chrono::duration<double>(now_ - *lease.begun).count();
  return expected && seconds > options_.straggler_factor * *expected;
}

bool Scheduler::GrantAgain(const Lease& lease, std::vector<WorkerId>& idle_workers) {
  const TaskId task = lease.task;
  JobRecord& job = jobs_.at(task.job);
  std::vector<WorkerId> takers = WhoTakes(job, idle_workers);
  std::erase(takers, lease.worker);
  const TaskCandidate candidate = CandidateOf(job, task, takers);
  const std::optional<Placement> placement = ChoosePlacement({&candidate, 1}, takers);
  if (!placement) return false;
  const LeaseId id(next_lease_);
  std::optional<GrantedTask> granted = job.progress->TakeAgain(task, id);
  if (!granted) return false;
  ++job.duplicates;
  std::erase(idle_workers, placement->worker);
  Hand(job, *placement, id, std::move(*granted), true);
  return true;
}

void Scheduler::Overtake(LeaseId id) {
  workers_.Revoke(id);
  const Lease& lease = *workers_.FindLease(id);
  Add(Revoke{lease.worker, id});
  AddEnd(id, lease.task, AttemptOutcome::kOvertaken);
}

}  // namespace depthfarm
