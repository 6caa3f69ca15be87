#include "coordinator/scheduling/worker_table.h"

#include <algorithm>
#include <utility>

namespace depthfarm {

Worker& WorkerTable::Join(const WorkerJoined& event, TimePoint now) {
  Worker& worker = workers_[event.worker];
  worker.id = event.worker;
  worker.name = event.name;
  worker.slots = event.slots;
  worker.ahead = event.ahead;
  worker.memory_bytes = event.memory_bytes;
  worker.tags = event.tags;
  worker.algorithm_version = event.algorithm_version;
  worker.told_to_end = false;
  worker.last_heard = now;
  worker.ask.reset();
  worker.told_jobs.clear();
  WorkersChanged();
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

void WorkerTable::Remove(WorkerId id) {
  workers_.erase(id);
  WorkersChanged();
}

void WorkerTable::Drain(WorkerId id) {
  workers_.at(id).draining = true;
  WorkersChanged();
}

void WorkerTable::WorkersChanged() {
  ++generation_;
  num_slots_ = 0;
  for (const auto& [id, worker] : workers_) num_slots_ += worker.draining ? 0 : static_cast<std::size_t>(worker.slots);
}

Lease& WorkerTable::AddLease(LeaseId id, Lease lease) {
  Worker& worker = workers_.at(lease.worker);
  worker.leases.insert(id);
  worker.memory_taken += lease.memory_bytes;
  worker.alone += lease.alone ? 1 : 0;
  ++leases_of_[lease.task.job];
  if (lease.work) ++under_way_[*lease.work];
  return leases_[id] = std::move(lease);
}

Lease* WorkerTable::FindLease(LeaseId id) {
  const auto lease = leases_.find(id);
  return lease == leases_.end() ? nullptr : &lease->second;
}

void WorkerTable::Revoke(LeaseId id) {
  Lease& lease = leases_.at(id);
  if (std::exchange(lease.revoked, true)) return;
  if (Worker* worker = Find(lease.worker)) ++worker->revoked;
}

void WorkerTable::EndLease(LeaseId id) {
  const auto lease = leases_.find(id);
  if (lease == leases_.end()) return;
  if (Worker* worker = Find(lease->second.worker)) {
    worker->leases.erase(id);
    worker->memory_taken -= lease->second.memory_bytes;
    worker->alone -= lease->second.alone ? 1 : 0;
    worker->revoked -= lease->second.revoked ? 1 : 0;
  }
  const auto count = leases_of_.find(lease->second.task.job);
  if (--count->second == 0) leases_of_.erase(count);
  if (const auto& work = lease->second.work; work && --under_way_.at(*work) == 0) under_way_.erase(*work);
  leases_.erase(lease);
}

int WorkerTable::LeasesOf(JobId job) const {
  const auto count = leases_of_.find(job);
  return count == leases_of_.end() ? 0 : count->second;
}

void WorkerTable::MarkBegun(TimePoint now) {
  for (const auto& [id, worker] : workers_) {
    int slots = worker.slots;
    for (const LeaseId lease_id : worker.leases) {
      Lease& lease = leases_.at(lease_id);
      if (lease.revoked) continue;
      if (slots-- <= 0) break;
      if (!lease.begun) lease.begun = now;
    }
  }
}

std::vector<LeaseId> WorkerTable::BehindSlots(const Worker& worker) const {
  std::vector<LeaseId> behind;
  if (static_cast<int>(worker.leases.size()) - worker.revoked <= worker.slots) return behind;
  int before = 0;
  for (const LeaseId id : worker.leases) {
    if (leases_.at(id).revoked) continue;
    if (before >= worker.slots) behind.push_back(id);
    ++before;
  }
  return behind;
}

WorkerTable::Room WorkerTable::RoomOf(const Worker& worker, TimePoint now, Milliseconds max_age) const {
  if (worker.draining || worker.alone > 0 || !worker.ask || now - worker.ask->received >= max_age) return Room::kNone;
  const int tasks = static_cast<int>(worker.leases.size()) - worker.revoked;
  if (tasks < worker.slots) return Room::kSlot;
  return tasks < worker.slots + worker.ahead ? Room::kAhead : Room::kNone;
}

bool WorkerTable::AnyFor(const WorkerNeeds& needs) const {
  return std::ranges::any_of(workers_, [&](const auto& entry) { return entry.second.Takes(needs); });
}

}  // namespace depthfarm
