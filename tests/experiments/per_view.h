#ifndef DEPTHFARM_TESTS_EXPERIMENTS_PER_VIEW_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_PER_VIEW_H_

#include <vector>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "common/job/resolved_job.h"

namespace depthfarm {

// What estimating all views together is worth: the same segments, matching cost, smoothness and alpha-expansion as a
// job without partition and refinement, but a match rewards a segment by the pictures alone, whatever depth the other
// view has there. Each reward counts twice, as the joint energy has it from both ends of the match, so that
// smoothness weighs the same (counted once, which is smoothing 2, PSNR-Y of cam2 of the arcs of seeds 1 to 4 at 640 x
// 480 rises by 0.4 dB). Result: one map per view of the job, own z. kInvalidArgument: a matching_offset with which the
// reward of so many neighbours leaves 16 bits; what AnalyseView refuses.
[[nodiscard]] Result<std::vector<DepthMap>> PerViewOfFrame(const ResolvedJob& job,
                                                           const std::vector<YcbcrImage>& pictures);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_PER_VIEW_H_
