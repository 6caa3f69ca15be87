#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_COMMITTED_FRAME_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_COMMITTED_FRAME_H_

#include <cstdint>
#include <map>
#include <vector>

#include "common/job/task_spec.h"

namespace depthfarm {

// A frame (or a part of a rendering job) whose files are in place: what the job's manifest will say of it.
struct CommittedFrame {
  struct File {
    ContentDigest sha256{};
    std::uint64_t bytes = 0;
    bool operator==(const File&) const = default;
  };
  std::vector<File> files;                     // in the order of JobPlan::OutputPaths
  std::vector<ContentDigest> picture_digests;  // by view; none of a rendering job
  bool operator==(const CommittedFrame&) const = default;
};

// By number in the job.
using CommittedFrames = std::map<int, CommittedFrame>;

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_COMMITTED_FRAME_H_
