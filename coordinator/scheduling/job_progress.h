#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_JOB_PROGRESS_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_JOB_PROGRESS_H_

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "coordinator/planning/artifact_keys.h"
#include "coordinator/planning/cost_model.h"
#include "coordinator/planning/job_plan.h"
#include "coordinator/planning/remaining_time.h"
#include "coordinator/scheduling/actions.h"
#include "coordinator/scheduling/artifact_directory.h"
#include "coordinator/scheduling/job_results.h"
#include "coordinator/scheduling/snapshot.h"
#include "coordinator/scheduling/task_table.h"

namespace depthfarm {

// Who is named to a worker as holding an artifact: at most a few, for each lease others first.
[[nodiscard]] std::vector<WorkerId> HoldersToTell(const ArtifactDirectory& directory, const ArtifactKey& key,
                                                  LeaseId lease);

// How far one job is: its open GOPs, which tasks are ready, what they made. Knows nothing of workers, leases and time.
//
// A task is ready when its prerequisites are done and somebody holds their artifacts. A blocked task watches one
// missing prerequisite and looks again when that one is done, so that the work per task does not grow with the number
// of inputs that arrive. Estimate, Merge, Refine and Assess tasks whose artifact somebody holds already are done
// without running; what Analyse makes only the worker that reads the picture knows.
class JobProgress {
 public:
  // `directory` must outlive the job. Prepare is ready from the start. `committed` frames are of the job, with as many
  // files and digests as it has: their files are there, Prepare checks that, and only tasks that others need run again.
  JobProgress(PlannedJob job, const ArtifactDirectory& directory, int max_setbacks,
              const CommittedFrames& committed = {}, bool ran_before = false);
  JobProgress(const JobProgress&) = delete;
  JobProgress& operator=(const JobProgress&) = delete;

  [[nodiscard]] const JobPlan& plan() const { return plan_; }
  [[nodiscard]] const TaskTable& table() const { return table_; }
  [[nodiscard]] Task* Find(const TaskId& id) { return table_.Find(id); }

  [[nodiscard]] bool HasUnopenedGop() const { return num_unopened_gops() > 0; }
  [[nodiscard]] int num_unopened_gops() const { return plan_.num_gops() - next_gop_; }
  [[nodiscard]] int num_open_gops() const { return static_cast<int>(open_gops_.size()); }
  // GOP -> how many of its frames are not committed.
  [[nodiscard]] const std::map<int, int>& open_gops() const { return open_gops_; }
  // Passes over GOPs that were committed before.
  void OpenNextGop();

  // What names the work of a task that became ready: its output key, of Analyse its request; of other kinds nothing.
  [[nodiscard]] const std::optional<ArtifactKey>& WorkOf(const TaskId& id) const { return table_.Find(id)->work; }
  // That the task is expected to take (CostModel), beside the process.
  [[nodiscard]] std::uint64_t MemoryOf(const TaskId& id) const {
    return costs_.Of(id).peak_memory_bytes - kProcessMemoryBytes;
  }
  // Leases a ready task, if its inputs are still there; else it (or what it needs) is put back and the result is empty.
  [[nodiscard]] std::optional<GrantedTask> Take(const TaskId& id, LeaseId lease);
  // Leases a leased task a second time; empty if it has two leases or had them before, writes into a folder, or an
  // input of it is lost.
  [[nodiscard]] std::optional<GrantedTask> TakeAgain(const TaskId& id, LeaseId lease);
  // A leased task goes back to be done again; nothing for a task that is not leased.
  void PutBack(const TaskId& id);

  // Applies the result of a leased task, whose artifact is in the directory. The result says whether an earlier run of
  // the task made other bytes under the same key (a determinism violation). kInternal: not what the task had to make;
  // the task stays leased.
  [[nodiscard]] Result<bool> Finish(const TaskFinished& result);

  // Of a frame whose Commit is done.
  [[nodiscard]] CommittedFrame CommittedOf(int frame) const;

  // The artifacts are held by nobody any more. Tasks that made them and that unfinished tasks need run again.
  void LoseArtifacts(const std::vector<ArtifactKey>& keys);
  // True if an unfinished task reads the artifact, or it is a result of a job that keeps them.
  [[nodiscard]] bool Needs(const ArtifactKey& key) const;
  // True for the bundle of a frame that is done, of a job that keeps its results.
  [[nodiscard]] bool IsResult(const ArtifactKey& key) const { return frame_of_bundle_.contains(key); }
  // The artifacts that a task reads, in its order; those that nobody holds are left out.
  [[nodiscard]] std::vector<ArtifactInfo> InputsOf(const TaskId& id) const;
  // The artifacts that no unfinished task of the job reads any more, since the last call.
  [[nodiscard]] std::vector<ArtifactKey> TakeReleased();
  // Bundles of frames that were committed before and that nobody has announced by now are lost. A job that keeps its
  // results is not done before.
  void ConfirmCommitted();
  [[nodiscard]] bool confirmed() const { return confirmed_; }
  // Frames whose bundles were lost, since the last call.
  [[nodiscard]] std::vector<int> TakeLostFrames() { return std::exchange(lost_frames_, {}); }
  // A task whose artifact or inputs were lost more often than `max_setbacks`.
  [[nodiscard]] const std::optional<TaskId>& worn_out() const { return worn_out_; }
  void CountSetback(const TaskId& id);

  // The job will not go on: all tasks are forgotten, their artifacts released.
  void Abandon();
  // After Abandon: adds the Cleanup task, ready.
  void StartCleanup();
  [[nodiscard]] bool prepare_was_granted() const { return prepare_was_granted_; }
  // Manifest, or after Abandon Cleanup, is done.
  [[nodiscard]] bool done() const { return done_; }

  // What was made so far.
  [[nodiscard]] const JobResults& results() const { return results_; }
  // The same at the end of the job.
  [[nodiscard]] JobResults TakeResults() { return std::move(results_); }

  [[nodiscard]] int frames_done() const { return frames_done_; }
  [[nodiscard]] int files_done() const { return files_done_; }
  [[nodiscard]] const RemainingTime& remaining() const { return remaining_; }
  [[nodiscard]] const std::array<StageSnapshot, kNumTaskKinds>& stages() const { return stages_; }

 private:
  struct EmittedFrame {
    std::string staging;
    std::vector<OutputFile> files;  // of each view
  };
  // Activation decides between blocked, ready and done by what is there now. It is queued, not nested: a reused chain
  // of P frames may be long.
  void Queue(const TaskId& id) { to_activate_.push_back(id); }
  void Settle();
  void Activate(const TaskId& id);
  [[nodiscard]] bool IsSatisfied(const TaskId& id) const;
  void Reopen(const TaskId& id);
  void MarkDone(const TaskId& id);
  void CommitFrame(int frame);
  void AddCommitted(int frame, const CommittedFrame& committed);
  void AddManifest();
  [[nodiscard]] std::vector<OutputFile> DoneFiles() const;
  // Whether a task must not run again: it ends a frame that was committed before.
  [[nodiscard]] bool IsBehind(const TaskId& id) const;
  // True, and its tasks are counted, if all of a GOP was committed before and none of it is needed.
  [[nodiscard]] bool PassOver(int gop);
  void Open(int gop);
  // One task less reads what the task makes.
  void NotNeededBy(const TaskId& id);
  // Of a GOP whose frames are committed: those of the I frame that all GOPs share, or all others.
  void RemoveTasks(int gop, bool of_shared_frame);
  // The bundle of a frame that was done is lost: the frame is not done any more.
  void LoseFrame(int frame);
  void DropResult(int frame);
  // Opens a GOP whose frames were done again, for those whose bundles are lost.
  void RestoreGop(int gop);
  void SetArtifact(const TaskId& id, const ArtifactInfo& artifact);
  void ForgetProducer(const TaskId& id, const ArtifactKey& key);
  [[nodiscard]] std::vector<TaskInput> BoundInputs(const TaskId& id) const;
  [[nodiscard]] std::optional<ArtifactKey> OutputKey(const TaskId& id, const std::vector<TaskInput>& inputs) const;
  [[nodiscard]] ArtifactKey AnalysisRequest(const TaskId& id) const;
  [[nodiscard]] TaskSpec Spec(const TaskId& id) const;
  [[nodiscard]] Status CheckResult(const TaskFinished& result, const Task& task) const;
  [[nodiscard]] StageSnapshot& Stage(TaskKind kind) { return stages_[static_cast<std::size_t>(kind)]; }

  JobPlan plan_;
  ArtifactKeys keys_;
  CostModel costs_;  // of plan_
  RemainingTime remaining_;
  const ArtifactDirectory& directory_;
  const int max_setbacks_;
  TaskTable table_;
  std::vector<TaskId> to_activate_;
  int next_gop_ = 0;
  std::map<int, int> open_gops_;
  std::map<ArtifactKey, std::set<TaskId>> producers_;
  std::map<int, EmittedFrame> emitted_;  // frames whose Commit is not done
  JobResults results_;
  std::vector<bool> committed_before_;          // frames that were when the job began; empty if none was
  std::map<ArtifactKey, int> frame_of_bundle_;  // of a job that keeps its results
  std::map<int, int> losses_;                   // how often the bundle of a frame was lost
  std::vector<int> lost_frames_;
  bool confirmed_ = true;  // that the bundles of frames committed before are there
  bool abandoned_ = false;
  std::vector<ArtifactKey> released_;
  std::optional<TaskId> worn_out_;
  std::array<StageSnapshot, kNumTaskKinds> stages_;
  int frames_done_ = 0;
  int files_done_ = 0;  // of those frames
  bool prepare_was_granted_ = false;
  bool done_ = false;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_JOB_PROGRESS_H_
