#include "coordinator/scheduling/worker_table.h"

#include <algorithm>

namespace depthfarm {

Worker& WorkerTable::Join(const WorkerJoined& event, TimePoint now) {
  Worker& worker = workers_[event.worker];
  worker.id = event.worker;
  worker.name = event.name;
  worker.slots = event.slots;
  worker.ahead = event.ahead;
  worker.memory_bytes = event.memory_bytes;
  worker.tags = event.tags;
  worker.told_to_end = false;
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

Lease& WorkerTable::AddLease(LeaseId id, Lease lease) {
  workers_[lease.worker].leases.insert(id);
  ++leases_of_[lease.task.job];
  if (lease.work) ++under_way_[*lease.work];
  return leases_[id] = std::move(lease);
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
  if (const auto& work = lease->second.work; work && --under_way_.at(*work) == 0) under_way_.erase(*work);
  leases_.erase(lease);
}

int WorkerTable::LeasesOf(JobId job) const {
  const auto count = leases_of_.find(job);
  return count == leases_of_.end() ? 0 : count->second;
}

WorkerTable::Room WorkerTable::RoomOf(const Worker& worker, TimePoint now, Milliseconds max_age) const {
  if (worker.draining || !worker.ask || now - worker.ask->received >= max_age) return Room::kNone;
  const auto tasks = std::ranges::count_if(worker.leases, [&](LeaseId id) { return !leases_.at(id).revoked; });
  if (tasks < worker.slots) return Room::kSlot;
  return tasks < worker.slots + worker.ahead ? Room::kAhead : Room::kNone;
}

bool WorkerTable::HasMemory(const Worker& worker, std::uint64_t bytes) const {
  if (worker.memory_bytes == 0) return true;
  std::uint64_t taken = 0;
  for (const LeaseId id : worker.leases) taken += leases_.at(id).memory_bytes;
  return taken + bytes <= worker.memory_bytes;
}

bool WorkerTable::IsEmpty(const Worker& worker) const {
  return std::ranges::all_of(worker.leases, [&](LeaseId id) { return leases_.at(id).revoked; });
}

bool WorkerTable::AnyFor(const std::set<std::string>& tags) const {
  return std::ranges::any_of(workers_, [&](const auto& entry) { return entry.second.Takes(tags); });
}

std::size_t WorkerTable::num_slots() const {
  std::size_t slots = 0;
  for (const auto& [id, worker] : workers_) slots += worker.draining ? 0 : static_cast<std::size_t>(worker.slots);
  return slots;
}

}  // namespace depthfarm
