#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_WORKER_TABLE_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_WORKER_TABLE_H_

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/planning/cost_model.h"
#include "coordinator/scheduling/events.h"

namespace depthfarm {

// What a job asks of the workers that take its tasks.
struct WorkerNeeds {
  std::set<std::string> tags;
  std::uint32_t algorithm_version = kAlgorithmVersion;  // exactly: another one makes other depth
};

// A worker that joined and was heard of within a lease.
struct Worker {
  // Whether it takes tasks of a job with these needs.
  [[nodiscard]] bool Takes(const WorkerNeeds& needs) const {
    return !draining && algorithm_version == needs.algorithm_version && std::ranges::includes(tags, needs.tags);
  }
  // Whether its memory is enough for a task of this size alone; beside the tasks it has.
  [[nodiscard]] bool IsLarge(std::uint64_t bytes) const {
    return memory_bytes == 0 || kProcessMemoryBytes + bytes <= memory_bytes;
  }
  [[nodiscard]] bool HasMemory(std::uint64_t bytes) const { return IsLarge(memory_taken + bytes); }

  WorkerId id;
  std::string name;
  int slots = 1;                   // tasks that it computes at a time
  int ahead = 0;                   // tasks that it takes besides
  std::uint64_t memory_bytes = 0;  // for its tasks; 0: no bound
  std::set<std::string> tags;
  std::uint32_t algorithm_version = kAlgorithmVersion;
  bool draining = false;
  bool told_to_end = false;
  TimePoint last_heard;
  struct Ask {
    std::uint64_t id = 0;
    TimePoint received;
  };
  std::optional<Ask> ask;           // the newest, until it is granted
  std::set<LeaseId> leases;         // with those that were revoked and did not end yet
  int revoked = 0;                  // how many of these were
  std::uint64_t memory_taken = 0;   // by the tasks of all of these
  int alone = 0;                    // how many of these let nothing beside them
  std::map<JobId, bool> told_jobs;  // whose JobConfig was sent to it; false: it may not have come
  std::uint64_t tasks_done = 0;
};

// One task in the hands of one worker.
struct Lease {
  TaskId task;
  WorkerId worker;
  TimePoint expires;
  std::vector<std::pair<ArtifactKey, std::vector<WorkerId>>> told;  // where the worker was told to find its inputs
  std::optional<ArtifactKey> work;                                  // JobProgress::WorkOf
  std::uint64_t memory_bytes = 0;                                   // that the task is expected to take
  bool revoked = false;                 // its result is not wanted; it counts until the worker is known to have stopped
  bool duplicate = false;               // the second one of a task that is leased
  bool alone = false;                   // its worker gets nothing else meanwhile
  std::optional<TimePoint> begun = {};  // when a slot was free for it, as far as is known here
  // The newest of the worker's messages that named it, so that it is known to have had the grant; 0: none.
  std::uint64_t named_by_ask = 0;
  std::uint64_t named_by_heartbeat = 0;
  std::optional<WorkerId> asked_back_for = {};  // the free worker that the task was asked back for
  TimePoint asked_back_at = {};
};

// Workers and their leases, kept consistent with each other.
class WorkerTable {
 public:
  // Adds the worker or renews its name and room; its asks and known jobs are forgotten, its leases are not.
  Worker& Join(const WorkerJoined& event, TimePoint now);
  // Null when it never joined or is out.
  [[nodiscard]] Worker* Find(WorkerId id);
  [[nodiscard]] const Worker* Find(WorkerId id) const;
  // Its leases must have ended.
  void Remove(WorkerId id);
  void Drain(WorkerId id);

  Lease& AddLease(LeaseId id, Lease lease);
  [[nodiscard]] Lease* FindLease(LeaseId id);
  // Whether some lease is for this work (Lease::work).
  [[nodiscard]] bool IsUnderWay(const ArtifactKey& work) const { return under_way_.contains(work); }
  // Its result is not wanted any more; it counts until EndLease.
  void Revoke(LeaseId id);
  void EndLease(LeaseId id);
  // How many leases of the job there are, with those that were revoked and did not end yet.
  [[nodiscard]] int LeasesOf(JobId job) const;
  // The worker's leases whose tasks it can't have begun, as far as is known here: it begins them in the order of their
  // leases, and these have as many before them as it has slots. Revoked ones do not count.
  [[nodiscard]] std::vector<LeaseId> BehindSlots(const Worker& worker) const;

  // Notes of all leases that are not behind slots, and were not before, that they are begun (Lease::begun).
  void MarkBegun(TimePoint now);

  // What a worker that asked less than `max_age` ago has room for.
  enum class Room {
    kNone,   // it did not ask, or has all the tasks it takes (revoked ones do not count)
    kAhead,  // a task whose inputs it fetches while it computes others
    kSlot,   // a task that it computes at once
  };
  [[nodiscard]] Room RoomOf(const Worker& worker, TimePoint now, Milliseconds max_age) const;
  // Whether any worker takes tasks of a job with these needs.
  [[nodiscard]] bool AnyFor(const WorkerNeeds& needs) const;
  // How many tasks all workers compute at a time; those that are drained do not count.
  [[nodiscard]] std::size_t num_slots() const { return num_slots_; }
  // Grows whenever a worker joins, leaves or is drained: what AnyFor says may have changed.
  [[nodiscard]] std::uint64_t generation() const { return generation_; }

  [[nodiscard]] std::map<WorkerId, Worker>& workers() { return workers_; }
  [[nodiscard]] const std::map<WorkerId, Worker>& workers() const { return workers_; }
  [[nodiscard]] const std::map<LeaseId, Lease>& leases() const { return leases_; }

 private:
  void WorkersChanged();

  std::map<WorkerId, Worker> workers_;
  std::size_t num_slots_ = 0;
  std::uint64_t generation_ = 0;
  std::map<LeaseId, Lease> leases_;
  std::map<JobId, int> leases_of_;        // jobs with any
  std::map<ArtifactKey, int> under_way_;  // leases of each work
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_WORKER_TABLE_H_
