#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_COMMITTED_FRAME_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_COMMITTED_FRAME_H_

#include <map>
#include <optional>
#include <vector>

#include "common/job/task_spec.h"

namespace depthfarm {

// A frame (or a part of a rendering job) whose files are in place, or in a bundle that a worker keeps: what the job's
// manifest will say of it.
struct CommittedFrame {
  std::vector<FileDigest> files;               // in the order of JobPlan::OutputPaths
  std::vector<ContentDigest> picture_digests;  // by view; none of a rendering job
  std::optional<ArtifactInfo> bundle = {};     // of a job that keeps its results
  bool operator==(const CommittedFrame&) const = default;
};

// By number in the job.
using CommittedFrames = std::map<int, CommittedFrame>;

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_COMMITTED_FRAME_H_
