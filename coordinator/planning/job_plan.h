#ifndef DEPTHFARM_COORDINATOR_PLANNING_JOB_PLAN_H_
#define DEPTHFARM_COORDINATOR_PLANNING_JOB_PLAN_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/level_partition.h"
#include "common/job/task_spec.h"

namespace depthfarm {

inline constexpr int kNumTaskKinds = static_cast<int>(TaskKind::kCleanup) + 1;

// A job as it is planned: what its tasks have in common and where its pictures are.
struct PlannedJob {
  JobConfig config;
  std::vector<std::vector<std::string>> pictures;   // [view][frame of the job], absolute paths
  std::vector<std::vector<GuideFiles>> guides;      // the same; empty: no view has any
  std::vector<std::vector<SourceDigests>> uploads;  // the same; empty: files are opened by their paths
  ArtifactLocation uploads_from;                    // where they are served
  std::vector<VirtualPicture> views;                // of a rendering job: all that it makes, kViewsPerPart to a part
};

// Neighbours on a path share sources, which take longer to read than a view takes to render; eight views are a second
// or two of work.
inline constexpr int kViewsPerPart = 8;
[[nodiscard]] int NumParts(std::size_t num_views);

// An input of a task before anything has run: who makes it.
struct PlannedInput {
  TaskId producer;
  InputRole role = InputRole::kAnalysis;
  int view = 0;
  bool operator==(const PlannedInput&) const = default;
};

// True for the kinds whose result is an artifact in every job: Analyse, Estimate, Merge, Refine, Assess.
[[nodiscard]] bool MakesArtifact(TaskKind kind);

// True for the kinds that make files: Emit, Render.
[[nodiscard]] bool MakesFiles(TaskKind kind);

// The task graph of a job, computed on demand: nothing is stored per task. GOPs do not depend on each other.
//
//   Prepare -----------------------------------------.
//   Analyse(f, v) -> Estimate(f, b) -> Merge(f, r, p) -> Refine(f, r, v) -> Emit(f) -> Commit(f) -> Manifest
//        | `-> Estimate(f + 1, b), and those of the whole GOP if f is its I frame; so with Refine(f, last, v)
//        |
//        `-> Analyse(f + 1, v), if that is a P frame
//
// Where a job assesses, Refine(f, last, v) -> Assess(f, v) -> Emit(f) besides. Of P frames Refine has round 0 and the
// last ones (ResolvedJob::FirstRefineRound).
//
// Of a rendering job: Prepare -> Render(f) -> Commit(f) -> Manifest, f a part.
// Of a job that keeps its results there is neither Prepare, Commit nor Manifest; the result of Emit is an artifact.
class JobPlan {
 public:
  explicit JobPlan(PlannedJob job);

  [[nodiscard]] const PlannedJob& job() const { return job_; }
  [[nodiscard]] const ResolvedJob& resolved() const { return job_.config.resolved; }

  [[nodiscard]] int num_gops() const;
  // All tasks of a GOP, prerequisites before what needs them.
  [[nodiscard]] std::vector<TaskId> TasksOfGop(int gop) const;
  [[nodiscard]] int GopOf(int frame) const { return resolved().GopOf(frame); }

  // Prepare, Manifest, Cleanup.
  [[nodiscard]] TaskId OfJob(TaskKind kind) const { return {job_.config.job, 0, kind, 0, 0}; }

  // What a task reads, in the order of its TaskSpec: by role, then by view.
  [[nodiscard]] std::vector<PlannedInput> Inputs(const TaskId& id) const;
  // The tasks that must be done before `id`, each once, ascending. Manifest, which needs every Commit, lists Prepare
  // alone: the caller counts.
  [[nodiscard]] std::vector<TaskId> Prerequisites(const TaskId& id) const;

  // The task whose result is the label field of the frame.
  [[nodiscard]] TaskId FinalLabels(int frame) const;
  // The task whose result is the refined depth of the view after `round` rounds; -1: after the last.
  [[nodiscard]] TaskId Refined(int frame, int view, int round = -1) const;
  // Whether GOPs refer to the I frame of the first one.
  [[nodiscard]] bool shares_i_frame() const { return resolved().params.anchor == Anchor::kShared && num_gops() > 1; }
  // The tasks of the first frame whose results those GOPs read.
  [[nodiscard]] std::vector<TaskId> SharedByGops() const;
  // The confidence of a view; only of jobs that ask for it (EstimationParams::assesses).
  [[nodiscard]] TaskId Assessed(int frame, int view) const;
  // The task that makes a frame's depth files.
  [[nodiscard]] TaskId Emitted(int frame) const { return {job_.config.job, frame, TaskKind::kEmit, 0, 0}; }
  // How many tasks of a kind the job has (Cleanup: 0).
  [[nodiscard]] std::uint64_t Total(TaskKind kind) const;

  // True for a job whose files stay artifacts of Emit.
  [[nodiscard]] bool keeps_results() const { return job_.config.keeps_results; }
  // True for the kinds whose result is an artifact in this job.
  [[nodiscard]] bool MakesArtifact(TaskKind kind) const;
  // True for the kinds that write into a staging folder in this job.
  [[nodiscard]] bool StagesFiles(TaskKind kind) const { return MakesFiles(kind) && !keeps_results(); }
  // The kind of the last task of a frame: Commit, or Emit of a job that keeps its results.
  [[nodiscard]] TaskKind EndOfFrame() const { return keeps_results() ? TaskKind::kEmit : TaskKind::kCommit; }

  // True for a job that renders views.
  [[nodiscard]] bool renders() const { return job_.config.render.has_value(); }
  // The views that Render(part) makes.
  [[nodiscard]] std::span<const VirtualPicture> ViewsOf(int part) const;
  // What Emit(frame) must write, view by view, relative to DIR/depth: "cam0/0012.png", the number being the frame's
  // position in the sequence; what Render(frame) must write: ViewFileName. Numbers have four digits or more.
  [[nodiscard]] std::vector<std::string> OutputPaths(int frame) const;

 private:
  // The task that made partial result `index` of merge round `round` (0: the blocks); passing on makes no task.
  [[nodiscard]] TaskId PartialResult(int frame, int round, int index) const;
  [[nodiscard]] const std::vector<std::vector<MergePair>>& Rounds(int frame) const;
  // The round of refinement that follows `round` (0: the start) of a frame.
  [[nodiscard]] int RefineRoundAfter(int frame, int round) const;
  void AddAnalyses(int frame, InputRole role, std::vector<PlannedInput>& inputs) const;
  void AddInputsOfRefine(const TaskId& id, std::vector<PlannedInput>& inputs) const;
  // Analyses and depth after a round (-1: the last) of a view and of those it is compared with.
  void AddCompared(int frame, int own, int round, std::vector<PlannedInput>& inputs) const;

  PlannedJob job_;
  std::vector<std::vector<MergePair>> rounds_i_;
  std::vector<std::vector<MergePair>> rounds_p_;
};

// Bounds of one job: the Manifest task names every depth file in one message. kInvalidArgument names the bound.
[[nodiscard]] Status CheckPlannable(const ResolvedJob& job);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_PLANNING_JOB_PLAN_H_
