#ifndef DEPTHFARM_WORKER_EXECUTION_ANALYSIS_KEY_H_
#define DEPTHFARM_WORKER_EXECUTION_ANALYSIS_KEY_H_

#include <optional>

#include "common/job/task_spec.h"

namespace depthfarm {

// Names the analysis of a picture: SHA-256 of everything AnalyseView's result depends on, of the version of its bytes,
// and of nothing else, so that other jobs on the same pictures find it. Digests are those of the files' bytes.
struct AnalysisDigests {
  ContentDigest picture{};
  std::optional<ContentDigest> mask;
  std::optional<ContentDigest> prior;
  std::optional<ContentDigest> prior_confidence;
  std::optional<ArtifactKey> before;  // of a P frame: the key of the analysis of the frame before
};
[[nodiscard]] ArtifactKey AnalysisKey(const JobView& view, const EstimationParams& params,
                                      const AnalysisDigests& digests);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_ANALYSIS_KEY_H_
