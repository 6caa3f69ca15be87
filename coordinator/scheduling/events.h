#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_EVENTS_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_EVENTS_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "coordinator/planning/job_plan.h"
#include "coordinator/scheduling/committed_frame.h"
#include "coordinator/scheduling/job_results.h"

namespace depthfarm {

using TimePoint = std::chrono::steady_clock::time_point;
using Milliseconds = std::chrono::milliseconds;

// ---- what clients cause ----

// A job whose id is new and that CheckPlannable accepted.
struct JobSubmitted {
  PlannedJob job;
  std::string name;
  int priority = 0;                 // larger first
  std::set<std::string> tags = {};  // that a worker must have
  // Of a job that goes on after it failed, was cancelled or lost its coordinator: frames that need not be done again.
  CommittedFrames committed = {};
  bool ran_before = false;      // tasks of it may still run that were granted by an earlier coordinator
  bool serves_uploads = false;  // its submitter serves the pictures, and must be heard of
};
// The submitter of a job with uploads is there.
struct SubmitterHeard {
  JobId job;
};
struct JobCancelled {
  JobId job;
};

// Of a job that ended in an earlier life of the coordinator and kept them.
struct ResultsRestored {
  JobId job;
  JobResults results;
};

// Nobody can ask for the job any more: its results, if it kept them, are not wanted.
struct JobForgotten {
  JobId job;
};

// A worker shall get no more tasks, and end when it has none.
struct WorkerDrained {
  WorkerId worker;
};

// ---- what workers cause ----

// A worker said Hello, for the first time or again. What is known of its store and its leases is replaced.
struct WorkerJoined {
  WorkerId worker;
  std::string name;
  std::vector<ArtifactInfo> artifacts = {};
  std::vector<LeaseId> running = {};
  int slots = 1;                   // tasks that it computes at a time
  int ahead = 0;                   // tasks that it takes besides, to fetch their inputs meanwhile
  std::uint64_t memory_bytes = 0;  // for its tasks; 0: no bound
  std::set<std::string> tags = {};
  bool restarted = false;  // another process than the one that had its leases, which died
  std::uint32_t algorithm_version = kAlgorithmVersion;
};
// It has room for one more task.
struct WorkerAsked {
  WorkerId worker;
  std::uint64_t ask_id = 0;
  std::vector<LeaseId> running;  // with those that were revoked and are not over yet
};
struct WorkerHeard {
  WorkerId worker;
  std::uint64_t heartbeat_id = 0;
  std::vector<LeaseId> running;
};
struct TaskFinished {
  WorkerId worker;
  LeaseId lease;
  TaskId task;
  std::optional<ArtifactInfo> artifact;         // of the kinds that make one (MakesArtifact); its key is the output key
  std::vector<OutputFile> files;                // Emit, Render
  std::optional<ContentDigest> picture_digest;  // Analyse
  TaskStats stats;
};
struct TaskFailed {
  WorkerId worker;
  LeaseId lease;
  TaskId task;
  Status error;
  std::vector<ArtifactKey> missing_inputs;  // could be fetched nowhere
};
struct ArtifactsDropped {
  WorkerId worker;
  std::vector<ArtifactKey> keys;
};
// Said goodbye: its tasks go elsewhere, and that is nobody's failure.
struct WorkerLeft {
  WorkerId worker;
};
// Its process ended without a goodbye: what its slots computed failed with it, at once.
struct WorkerDied {
  WorkerId worker;
  std::string how;                 // after "the worker "
  std::vector<LeaseId> computing;  // what they were; empty: not told, as many of its leases as it has slots
  TaskLog last_words = {};         // what it wrote before
};

using Event =
    std::variant<JobSubmitted, SubmitterHeard, JobCancelled, ResultsRestored, JobForgotten, WorkerDrained, WorkerJoined,
                 WorkerAsked, WorkerHeard, TaskFinished, TaskFailed, ArtifactsDropped, WorkerLeft, WorkerDied>;

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_EVENTS_H_
