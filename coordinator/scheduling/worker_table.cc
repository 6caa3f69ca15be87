#include "coordinator/scheduling/worker_table.h"

#include <algorithm>

namespace depthfarm {

Worker& WorkerTable::Join(WorkerId id, const std::string& name, TimePoint now) {
  Worker& worker = workers_[id];
  worker.id = id;
  worker.name = name;
  worker.last_heard = now;
  worker.ask.reset();
  worker.known_jobs.clear();
  return worker;
}

Worker* WorkerTable::Find(WorkerId id) {
  const auto worker = workers_.find(id);
  return worker == workers_.end() ? nullptr : &worker->second;
}

const Worker* WorkerTable::Find(WorkerId id) const {
  const auto worker = workers_.find(id);
  return worker == workers_.end() ? nullptr : &worker->second;
}

void WorkerTable::Remove(WorkerId id) { workers_.erase(id); }

Lease& WorkerTable::AddLease(LeaseId id, const TaskId& task, WorkerId worker, TimePoint expires) {
  workers_[worker].leases.insert(id);
  ++leases_of_[task.job];
  return leases_[id] = Lease{task, worker, expires, {}, false};
}

Lease* WorkerTable::FindLease(LeaseId id) {
  const auto lease = leases_.find(id);
  return lease == leases_.end() ? nullptr : &lease->second;
}

void WorkerTable::EndLease(LeaseId id) {
  const auto lease = leases_.find(id);
  if (lease == leases_.end()) return;
  if (Worker* worker = Find(lease->second.worker)) worker->leases.erase(id);
  const auto count = leases_of_.find(lease->second.task.job);
  if (--count->second == 0) leases_of_.erase(count);
  leases_.erase(lease);
}

int WorkerTable::LeasesOf(JobId job) const {
  const auto count = leases_of_.find(job);
  return count == leases_of_.end() ? 0 : count->second;
}

bool WorkerTable::IsFree(const Worker& worker, TimePoint now, Milliseconds max_age) const {
  if (!worker.ask || now - worker.ask->received >= max_age) return false;
  return std::all_of(worker.leases.begin(), worker.leases.end(), [&](LeaseId id) { return leases_.at(id).revoked; });
}

}  // namespace depthfarm
