#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_SCHEDULER_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_SCHEDULER_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/scheduling/actions.h"
#include "coordinator/scheduling/analysis_memo.h"
#include "coordinator/scheduling/artifact_directory.h"
#include "coordinator/scheduling/events.h"
#include "coordinator/scheduling/gop_homes.h"
#include "coordinator/scheduling/job_progress.h"
#include "coordinator/scheduling/kept_results.h"
#include "coordinator/scheduling/placement.h"
#include "coordinator/scheduling/snapshot.h"
#include "coordinator/scheduling/worker_table.h"

namespace depthfarm {

struct SchedulerOptions {
  Milliseconds lease{6000};               // silence after which a task, or a worker, is given up
  Milliseconds cleanup_grace{30000};      // how long a failed job waits for its Cleanup before it ends without
  Milliseconds submitter_silence{30000};  // after which a job whose submitter serves its pictures fails
  int max_attempts = 4;                   // of one task, before its job fails
  int max_setbacks = 16;                  // times that a task's artifact or inputs may be lost, before its job fails
  Milliseconds retry_pause{500};          // of a task that failed, before its next attempt; twice as long after each
  Milliseconds longest_retry_pause{30000};
  bool duplicates = true;              // whether a task that takes too long is granted a second time
  double straggler_factor = 2;         // too long: so many times what is expected, and
  Milliseconds straggler_least{5000};  // at least this
  int ready_per_slot = 2;              // another GOP is opened when fewer tasks are ready for each slot of a worker
  int max_open_gops = 1024;            // of one job
  int gops_at_once = 64;               // opened for one event: it must take well less than a lease
  std::uint64_t first_lease = 1;       // a number that no earlier coordinator of the same workers used
};

// All that the coordinator knows and decides. Holds no socket, file, thread or clock; the same events at the same times
// give the same actions. Not thread-safe: one owner.
//
//   Job     Running --last task--> Done;  --task gave up, or cancelled--> leases revoked, Cleanup --> Failed, Cancelled
//   Task    see TaskState;   Lease   granted --renewed by heartbeats--> result, failure, expiry, or revoked
//   Worker  joined --silent for a lease, dead, or goodbye--> out: its leases end, its artifacts are not counted on any
//   more
class Scheduler {
 public:
  explicit Scheduler(const SchedulerOptions& options);

  // Applies one event and returns what must now be done, in order. Events of workers that did not join are ignored.
  [[nodiscard]] std::vector<Action> Handle(const Event& event, TimePoint now);
  // Expires what is overdue at `now`. A second call at the same `now` returns nothing.
  [[nodiscard]] std::vector<Action> Tick(TimePoint now);

  [[nodiscard]] bool Knows(WorkerId worker) const { return workers_.Find(worker) != nullptr; }
  // The job that writes to the folder, if one does: a folder belongs to one job at a time.
  [[nodiscard]] std::optional<JobId> JobWritingTo(const std::string& output_dir) const;
  [[nodiscard]] std::optional<JobSnapshot> Job(JobId id) const;
  // Of a job that keeps its results: what it has made so far, or had when it ended; null when they were forgotten.
  [[nodiscard]] const JobResults* ResultsOf(JobId id) const;
  // The workers to fetch an artifact from: at most a few.
  [[nodiscard]] std::vector<WorkerId> HoldersOf(const ArtifactKey& key) const {
    return HoldersToTell(directory_, key, LeaseId(0));
  }
  // By id. Jobs that ended are not among them.
  [[nodiscard]] std::vector<JobSnapshot> Jobs() const;
  [[nodiscard]] std::vector<WorkerSnapshot> Workers() const;
  // Of jobs that need no other tags than these; of all jobs.
  [[nodiscard]] Backlog BacklogOf(const std::set<std::string>& tags) const;
  [[nodiscard]] Backlog TotalBacklog() const;

  // Whether it is the second one of a task that is leased.
  [[nodiscard]] bool IsDuplicate(LeaseId lease) const;

  // Results of leases that had ended before.
  [[nodiscard]] std::uint64_t late_results() const { return late_results_; }
  // True when nothing is kept: no job, lease, worker or artifact.
  [[nodiscard]] bool empty() const;

 private:
  struct JobRecord {
    std::string name;
    int priority = 0;
    WorkerNeeds needs;
    bool taken = false;            // whether any worker takes its tasks
    std::uint64_t last_grant = 0;  // number of its newest lease
    GopHomes homes;
    TimePoint submitted;
    // Of a job that ran before: by then its workers are back, and what the last coordinator granted is over.
    std::optional<TimePoint> at_rest;
    std::optional<TimePoint> submitter_due;  // of a job with uploads: when its submitter must have been heard of
    std::unique_ptr<JobProgress> progress;
    JobState ending = JobState::kRunning;  // what it will be when leases and Cleanup are over
    Status error;
    TimePoint cleanup_deadline;
    bool cleanup_started = false;
    std::map<TaskId, TimePoint> resting;  // tasks that failed: when they may be tried again
    std::optional<TaskId> failed_task;    // that it fails with
    std::uint64_t retries = 0;
    std::uint64_t duplicates = 0;
    std::uint64_t duplicates_won = 0;
    std::uint64_t violations = 0;
  };

  void On(const JobSubmitted& event);
  void On(const SubmitterHeard& event);
  void On(const JobCancelled& event);
  void On(const ResultsRestored& event);
  void On(const JobForgotten& event);
  void On(const WorkerDrained& event);
  void On(const WorkerJoined& event);
  void On(const WorkerAsked& event);
  void On(const WorkerHeard& event);
  void On(const TaskFinished& event);
  void On(const TaskFailed& event);
  void On(const ArtifactsDropped& event);
  void On(const WorkerLeft& event);
  void On(const WorkerDied& event);

  // Why a worker is gone, when what it was computing failed with it.
  struct Loss {
    Status reason;
    std::vector<LeaseId> computing = {};  // empty: not told, those that it can have begun
    TaskLog last_words = {};
  };

  // The lease of a result, ended; null (and a note) if it is not the worker's any more.
  [[nodiscard]] std::optional<Lease> EndLeaseOf(WorkerId worker, LeaseId lease, const TaskId& task);
  void RemoveWorker(Worker& worker, const Loss* lost);
  // What an ask or a heartbeat, the message `id` of these, says of the worker's leases: ends the revoked ones that it
  // names no more. One that no such message named may have crossed it, and begin yet. True if any ended.
  bool NoteRunning(const Worker& worker, const std::vector<LeaseId>& running, std::uint64_t id,
                   std::uint64_t Lease::*named_by);
  void AddArtifact(WorkerId worker, const ArtifactInfo& artifact, JobId job, const std::string& made_by);
  void LoseArtifacts(const std::vector<ArtifactKey>& keys);
  void AddViolation(JobId job, const ArtifactKey& key, const std::string& made_by);

  // scheduler_failures.cc: what becomes of a task whose attempt ended without a result.
  [[nodiscard]] Task* FindTask(const TaskId& id);
  // The task is ready again, unless another attempt of it goes on or it was not the lease's any more; no failure.
  void GiveBack(LeaseId id, const TaskId& task);
  // The task is ready again, or the job fails since its attempts are used up.
  void TryAgain(const TaskId& id);
  // The same as GiveBack, and a failure of the task. `died`: with its worker, or its worker was not heard of.
  void FailAttempt(LeaseId id, const Lease& lease, const Status& error, bool died = false);
  void ForgetInputs(JobRecord& job, const TaskFailed& event, const Lease& lease);
  // The worker is gone with all its leases. `lost`: null when none of them failed with it.
  void EndLeasesOf(const Worker& worker, const Loss* lost);
  // Whether the task is tried on a worker that has nothing else: others were lost with it.
  [[nodiscard]] bool IsTriedAlone(const Task& task) const;

  // scheduler_jobs.cc
  [[nodiscard]] JobRecord* FindJob(JobId id);
  void TaskDone(JobRecord& job, const TaskFinished& event, const Lease& lease);
  void EndJobBadly(JobId id, JobState state, const Status& error);
  void ReleaseArtifactsOf(JobRecord& job);
  void ReleaseUnneeded(const std::vector<ArtifactKey>& keys);
  [[nodiscard]] bool IsNeeded(const ArtifactKey& key) const;
  [[nodiscard]] bool IsResult(const ArtifactKey& key) const;
  void EndJobsWithoutSubmitter();
  void ConfirmCommitted();
  void AdvanceEndings();
  void EndDrainedWorkers();
  void UpdateTaken();
  void OpenGops();
  void Assign();
  // All jobs, next to be served first.
  [[nodiscard]] std::vector<JobId> JobsInFairOrder() const;
  // Of Analyse what such a task made when it was done before, if somebody holds it.
  [[nodiscard]] std::optional<ArtifactInfo> KnownOf(const JobRecord& job, const TaskId& task) const;
  void AddHolders(const ArtifactInfo& artifact, const std::vector<WorkerId>& free_workers,
                  TaskCandidate& candidate) const;
  // Work: of the free workers alone, unless one of them is too small or the task failed before.
  [[nodiscard]] TaskCandidate CandidateOf(JobRecord& job, const TaskId& task,
                                          const std::vector<WorkerId>& free_workers) const;
  // Marks workers that are not at home with the GOP of the task as ones to avoid, where they would read longer than
  // their help is worth and the home is at work on the GOP.
  void LeaveToHome(const JobRecord& job, const std::vector<WorkerId>& free_workers, TaskCandidate& candidate) const;
  [[nodiscard]] std::vector<WorkerId> WhoTakes(const JobRecord& job, const std::vector<WorkerId>& free_workers) const;
  // A task that was passed over because large workers lack the memory just now: one of them is held until it has it.
  void HoldFor(const TaskCandidate& candidate, const std::vector<WorkerId>& takers);
  void EndHolds();
  // Grants a task of the job: of those that end a frame, else of a GOP that a free worker is at home with, else of one
  // that has no home, else any. `ahead`: behind what the workers compute; of the last kind only to those that have no
  // GOP of the job, since others have work of their own by then.
  [[nodiscard]] bool AssignOneOf(JobRecord& job, bool ahead, std::vector<WorkerId>& free_workers);
  // Grants the most urgent of these tasks that one of the takers can have. Where none is granted and `hold`, workers
  // are held for those that lack memory.
  [[nodiscard]] bool AssignAmong(JobRecord& job, const ReadyRange& tasks, const std::vector<WorkerId>& takers,
                                 bool hold, std::vector<WorkerId>& free_workers);
  void MakeGrant(JobRecord& job, const Placement& placement);
  // Leases the task, which was taken, to the worker.
  void Hand(JobRecord& job, const Placement& placement, LeaseId lease_id, GrantedTask task, bool duplicate);
  // scheduler_duplicates.cc: grants what takes too long a second time, to workers that found nothing to do.
  void GrantDuplicates();
  [[nodiscard]] bool TakesTooLong(LeaseId id, const Lease& lease) const;
  // True if there is one of the idle workers for the task, who then is no longer among them.
  [[nodiscard]] bool GrantAgain(const Lease& lease, std::vector<WorkerId>& idle_workers);
  // The result of another attempt of the task was first.
  void Overtake(LeaseId id);
  // scheduler_rebalance.cc: asks back what waits behind the slots of others, for workers that found nothing ready.
  void Rebalance(std::vector<WorkerId> idle_workers);
  // Without those that a task was asked back for just now.
  void EraseAwaited(std::vector<WorkerId>& idle_workers) const;
  [[nodiscard]] std::vector<LeaseId> LeasesToAskBack() const;
  // True if there is one of the idle workers for the task, who then is no longer among them.
  [[nodiscard]] bool MayBeAskedBack(LeaseId id, const Lease& lease) const;
  [[nodiscard]] bool AskBackFor(LeaseId lease, std::vector<WorkerId>& idle_workers);
  void EndJob(JobId id, JobState state);
  // Workers with such room, longest waiting first.
  [[nodiscard]] std::vector<WorkerId> WorkersWith(WorkerTable::Room room) const;
  [[nodiscard]] std::size_t NumReady() const;
  // Grants one task of the job that is next to one of the workers, who then is no longer among them.
  [[nodiscard]] bool AssignNext(bool ahead, std::vector<WorkerId>& free_workers);
  [[nodiscard]] bool HasLeases(JobId id) const;
  // Of the slots that take the job, shared with the jobs that are not behind it.
  [[nodiscard]] double SlotsOf(JobId id, const JobRecord& job) const;
  [[nodiscard]] JobSnapshot Snapshot(JobId id, const JobRecord& job) const;
  // Everything that an event may have made possible.
  void Advance();
  [[nodiscard]] Backlog CountBacklog(const std::function<bool(const JobRecord&)>& counts) const;

  void Add(Action action);
  void AddEnd(LeaseId lease, const TaskId& task, AttemptOutcome outcome, const Status& error = {});
  void AddNote(Note::Severity severity, std::string event, std::vector<std::pair<std::string, std::string>> fields);

  const SchedulerOptions options_;
  TimePoint now_;                // of the event being handled
  std::vector<Action> actions_;  // of the event being handled
  bool idle_ = false;            // the event being handled makes nothing possible
  std::uint64_t next_lease_;
  ArtifactDirectory directory_;
  WorkerTable workers_;
  std::map<JobId, JobRecord> jobs_;
  AnalysisMemo analyses_;
  KeptResults results_;              // of jobs that ended
  std::map<WorkerId, TaskId> held_;  // gets nothing else, but of jobs of higher priority, until it has the memory
  std::uint64_t workers_seen_ = 0;   // WorkerTable::generation when JobRecord::taken was told
  std::uint64_t late_results_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_SCHEDULER_H_
