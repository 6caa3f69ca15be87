#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_JOB_RESULTS_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_JOB_RESULTS_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "common/job/task_spec.h"

namespace depthfarm {

// What a job has made so far, without the names of the files: its plan knows them.
struct JobResults {
  struct Frame {
    std::vector<FileDigest> files;       // empty: the frame is not done
    std::optional<ArtifactInfo> bundle;  // of a done frame, when the job keeps its results
  };
  std::vector<Frame> frames;
  std::vector<ContentDigest> picture_digests;  // by frame, then view; of pictures that were read
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_JOB_RESULTS_H_
