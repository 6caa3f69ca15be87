#ifndef DEPTHFARM_WORKER_EXECUTION_ANALYSIS_KEY_H_
#define DEPTHFARM_WORKER_EXECUTION_ANALYSIS_KEY_H_

#include "common/job/task_spec.h"

namespace depthfarm {

// Names the analysis of a picture: SHA-256 of everything AnalyseView's result depends on, and of nothing else, so that
// other jobs on the same pictures find it. `picture_digest` is that of the file's bytes.
[[nodiscard]] ArtifactKey AnalysisKey(const JobView& view, const EstimationParams& params,
                                      const ContentDigest& picture_digest);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_ANALYSIS_KEY_H_
