#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_SNAPSHOT_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_SNAPSHOT_H_

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/scheduling/events.h"

namespace depthfarm {

enum class JobState { kRunning, kDone, kFailed, kCancelled };

// What the tasks of one kind have used so far. Sums over successful attempts.
struct StageSnapshot {
  std::uint64_t tasks_done = 0;
  std::uint64_t tasks_total = 0;
  double cpu_seconds = 0;
  double wall_seconds = 0;
  std::uint64_t peak_memory_bytes = 0;  // the largest
  std::uint64_t fetched_bytes = 0;
  std::uint64_t sweeps = 0;
  std::uint64_t reused = 0;
  std::uint64_t left_aside = 0;            // TaskStats::left_aside
  std::optional<TaskId> first_left_aside;  // by frame, then view
};

struct RunningTask {
  TaskId task;
  WorkerId worker;
  std::string worker_name;
  bool duplicate = false;  // of a task that another worker has, too
};

struct JobSnapshot {
  JobId id;
  std::string name;
  std::string output_dir;
  bool keeps_results = false;  // then without output_dir
  int priority = 0;
  JobState state = JobState::kRunning;
  Status error;  // set as soon as the job begins to fail; the state follows when its leases and Cleanup are over
  int frames_done = 0;
  int frames_total = 0;
  std::array<StageSnapshot, kNumTaskKinds> stages;  // by TaskKind
  std::vector<RunningTask> running;
  std::optional<double> seconds_left;   // RemainingTime, on the job's share of the slots; not of a job that ends
  std::set<std::string> tags;           // that its workers must have
  std::uint32_t algorithm_version = 0;  // the same
  bool lacks_worker = false;            // there is none that takes its tasks
  std::uint64_t retries = 0;
  std::uint64_t duplicates = 0;       // tasks that were granted a second time since they took so long
  std::uint64_t duplicates_won = 0;   // of which that attempt was first
  std::optional<TaskId> failed_task;  // that the job failed with
  std::uint64_t determinism_violations = 0;
  TimePoint submitted;
  TimePoint ended;  // of a job that ended
};

struct WorkerSnapshot {
  WorkerId id;
  std::string name;
  int slots = 1;
  bool draining = false;
  std::set<std::string> tags;
  std::uint32_t algorithm_version = 0;
  std::vector<TaskId> running;
  TimePoint last_heard;
  std::uint64_t tasks_done = 0;
  std::uint64_t artifacts = 0;
  std::uint64_t artifact_bytes = 0;
};

// What the running jobs that workers of some tags may work for want: how many slots would not be idle.
struct Backlog {
  std::uint64_t leased = 0;         // tasks that workers have, each once
  std::uint64_t ready = 0;          // tasks that a free slot would get
  std::uint64_t unopened_gops = 0;  // each of them gives at least one ready task more when it is opened
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_SNAPSHOT_H_
