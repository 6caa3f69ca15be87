#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_ACTIONS_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_ACTIONS_H_

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/job/task_spec.h"
#include "coordinator/scheduling/snapshot.h"

namespace depthfarm {

// A task with all that its worker needs, but for the addresses of the workers that hold its inputs.
struct GrantedTask {
  TaskSpec spec;                               // inputs, and what is known, without locations
  std::vector<std::vector<WorkerId>> holders;  // per input, at most a few, never empty
  std::vector<WorkerId> holders_of_known;
};

struct Grant {
  WorkerId worker;
  LeaseId lease;
  std::uint64_t ask_id = 0;
  int attempt = 1;
  bool first_of_job = false;  // the worker may not have the JobConfig
  bool duplicate = false;     // another worker has the task, too
  GrantedTask task;
};
struct AcknowledgeHeartbeat {
  WorkerId worker;
  std::uint64_t heartbeat_id = 0;
  std::vector<LeaseId> unknown;
};
struct Revoke {
  WorkerId worker;
  LeaseId lease;
};
// Ask the worker for a task that waits behind its slots: it gives the task back (TaskFailed, kCancelled) unless it has
// begun it.
struct AskBack {
  WorkerId worker;
  LeaseId lease;
};
struct Release {
  WorkerId worker;
  std::vector<ArtifactKey> keys;
};
// The worker holds these results of a job that keeps them: it shall drop them last.
struct Keep {
  WorkerId worker;
  std::vector<ArtifactKey> keys;
};
// Tell the worker that no task of the job will come any more.
struct ForgetJob {
  WorkerId worker;
  JobId job;
};
// A frame's files are in place. What is remembered of it lets the job go on from there (JobSubmitted::committed).
struct FrameCommitted {
  JobId job;
  int frame = 0;
  CommittedFrame committed;
};
// The bundle that a frame was committed in is held by nobody any more.
struct FrameLost {
  JobId job;
  int frame = 0;
};
// The job left the scheduler; this is the last that it knows of it.
struct JobEnded {
  JobSnapshot job;
};
// How one attempt of a task ended.
enum class AttemptOutcome {
  kRunning,  // it did not end yet
  kDone,     // by computing
  kReused,   // done: its worker had the artifact already
  kFailed,
  kGivenBack,  // not begun, or its worker left: nobody's failure
  kRevoked,    // its job ended
  kOvertaken,  // the other attempt of the task ended it first
  kExpired,
  kWorkerLost,
};
// The lease is over, or its result is not wanted any more; comes once for each Grant.
struct AttemptEnded {
  LeaseId lease;
  TaskId task;
  AttemptOutcome outcome = AttemptOutcome::kDone;
  Status error;             // of kFailed, kExpired and kWorkerLost
  TaskLog last_words = {};  // of kWorkerLost: what its worker wrote before it died, where that is known
};
// The worker was silent for a lease, or died: it is out until it says Hello again.
struct WorkerLost {
  WorkerId worker;
  std::string name;
};
// The worker was drained and has no task left: tell it to end.
struct EndWorker {
  WorkerId worker;
};
// Something worth a log line.
struct Note {
  enum class Severity { kInfo, kWarning, kError };
  Severity severity = Severity::kInfo;
  std::string event;
  std::vector<std::pair<std::string, std::string>> fields;
};

using Action = std::variant<Grant, AcknowledgeHeartbeat, Revoke, AskBack, Release, Keep, ForgetJob, FrameCommitted,
                            FrameLost, JobEnded, AttemptEnded, WorkerLost, EndWorker, Note>;

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_ACTIONS_H_
