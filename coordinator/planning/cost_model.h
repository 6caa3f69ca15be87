#ifndef DEPTHFARM_COORDINATOR_PLANNING_COST_MODEL_H_
#define DEPTHFARM_COORDINATOR_PLANNING_COST_MODEL_H_

#include <cstdint>

#include "common/job/resolved_job.h"
#include "common/job/task.h"

namespace depthfarm {

// The processor that predicted seconds are of (docs/benchmarks.md, Predicted times).
inline constexpr const char* kCostMachine = "one core of a server of the early 2020s (Intel Xeon), release build";

// Memory of a worker process with its libraries, before it has any task.
inline constexpr std::uint64_t kProcessMemoryBytes = std::uint64_t{52} << 20;

// What a task is expected to take, before anything has run.
struct TaskCost {
  double seconds = 0;                   // CPU of one core (kCostMachine), its inputs in memory
  std::uint64_t peak_memory_bytes = 0;  // of a worker process (kProcessMemoryBytes) with nothing but this task
  std::uint64_t result_bytes = 0;       // as stored: of the artifact; Emit: of the files
  bool operator==(const TaskCost&) const = default;
};

// Costs of the tasks of a job, from its numbers alone: pixels, segments, levels, views, frame type and options. No
// picture is looked at: detail is taken to be between that of the rendered scenes and of the photographs behind the
// constants (cost_model.cc), and P frames to stand still in most places. A rendered job's CPU is right to a
// factor 1.5 and a stage's to a factor 2, a job's of photographs to a factor 2; other processors add to that. All I
// frames of a job cost the same, and so do all P frames.
class CostModel {
 public:
  // `job` must outlive the model.
  explicit CostModel(const ResolvedJob& job);

  // Of a task of the job; of a rendering job, whose pictures are not known here, a rule of thumb.
  [[nodiscard]] TaskCost Of(const TaskId& id) const;

  // CPU seconds until stored bytes that another worker made can be read: check, decompression, decoding.
  [[nodiscard]] static double SecondsToRead(std::uint64_t stored_bytes);

 private:
  [[nodiscard]] TaskCost Analyse(bool i_frame, const JobView& view) const;
  [[nodiscard]] TaskCost Estimate(bool i_frame) const;
  [[nodiscard]] TaskCost Merge(bool i_frame) const;
  [[nodiscard]] TaskCost Refine(bool i_frame, int round, const JobView& view) const;
  [[nodiscard]] TaskCost Assess(const JobView& view) const;
  [[nodiscard]] TaskCost Emit(bool i_frame) const;
  // Memory of what Refine and Assess read: analyses and refined depth of the view and of those it is compared with.
  [[nodiscard]] double ComparedBytes(const JobView& view) const;

  const ResolvedJob& job_;
  double pixels_ = 0;    // of all views
  double segments_ = 0;  // of all views
  int search_step_i_ = 1;
  int search_step_p_ = 1;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_PLANNING_COST_MODEL_H_
