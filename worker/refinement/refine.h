#ifndef DEPTHFARM_WORKER_REFINEMENT_REFINE_H_
#define DEPTHFARM_WORKER_REFINEMENT_REFINE_H_

#include <vector>

#include "worker/estimation/estimation.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {

// Continuous refinement of the labels of a frame: one slanted plane per segment, Gauss-Newton on colour differences
// against up to four views, `rounds` times; then a choice of plane for each pixel at depth jumps. Each round reads the
// other views' maps of the round before only, so the order of the views changes nothing.
[[nodiscard]] std::vector<RefinedView> RefinePlanes(const ResolvedJob& job, const FrameAnalysis& analysis,
                                                    const LabelField& labels, int rounds);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_REFINE_H_
