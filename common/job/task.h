#ifndef DEPTHFARM_COMMON_JOB_TASK_H_
#define DEPTHFARM_COMMON_JOB_TASK_H_

#include <array>
#include <compare>
#include <cstdint>
#include <string>

#include "common/base/strong_id.h"

namespace depthfarm {

using JobId = StrongId<struct JobIdTag, std::uint64_t>;
using LeaseId = StrongId<struct LeaseIdTag, std::uint64_t>;
using WorkerId = StrongId<struct WorkerIdTag, std::uint64_t>;

// What one task does (design section 3).
enum class TaskKind : std::uint8_t {
  kPrepare,   // of a job: the output folder is made ready, an older result in it is removed
  kAnalyse,   // of (frame, view): decode, Y'CbCr, SNIC, means, centres, adjacency        paper IV-C
  kEstimate,  // of (frame, block): alpha-expansion over all views on the block's levels    III, IV-A
  kMerge,     // of (frame, round, pair): two label fields -> one, two-label cut            IV-A, Fig. 3
  kRefine,    // of (frame, round, view): slanted planes instead of levels; round 0 starts from the labels
  kAssess,    // of (frame, view): confidence of the refined depth
  kRender,    // of a part of a rendering job: some virtual views, into the job's staging folder
  kEmit,      // of a frame: depth files of all views, into the job's staging folder
  kCommit,    // of a frame: the accepted attempt's files are renamed into place
  kManifest,  // of a job: depth.json is written, the staging folder removed
  kCleanup,   // of a job that failed or was cancelled: the staging folder is removed
};

// Names a task within its job. Unused parts are 0.
struct TaskId {
  JobId job;
  int frame = 0;  // 0-based in the job; of a rendering job: its part
  TaskKind kind = TaskKind::kAnalyse;
  int index = 0;  // view of kAnalyse and kAssess, block of kEstimate, round of kMerge and kRefine
  int pair = 0;   // pair of kMerge, view of kRefine
  // NOLINTNEXTLINE(modernize-use-nullptr): the 0 is the compiler's
  auto operator<=>(const TaskId&) const = default;
};

// SHA-256 that names an artifact: of its operation, algorithm version, parameters and input keys, not of its bytes.
using ArtifactKey = std::array<std::uint8_t, 32>;

// A stable word for logs, status and the wire: "analyse", ...
[[nodiscard]] std::string TaskKindName(TaskKind kind);
// E.g. "job 3 frame 12 merge round 1 pair 0".
[[nodiscard]] std::string TaskName(const TaskId& id);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_TASK_H_
