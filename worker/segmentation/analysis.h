#ifndef DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_H_
#define DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_H_

#include <stop_token>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "worker/segmentation/segment_map.h"
#include "worker/segmentation/view_prior.h"

namespace depthfarm {

// What one view of one frame is to the rest of the estimation: its picture and the segments that depth is estimated
// for.
struct ViewAnalysis {
  YcbcrImage picture;
  SegmentMap segments;
  ViewPrior prior = {};  // empty: none
  bool operator==(const ViewAnalysis&) const = default;
};

// Segments a view (SNIC, paper IV-C) and describes its segments. The actual number of segments is
// `segments.num_segments()`, as near `num_segments` as the seed grid allows.
// Errors as SegmentSnic.
[[nodiscard]] Result<ViewAnalysis> AnalyseView(YcbcrImage picture, int num_segments, double compactness,
                                               const std::stop_token& stop = {});

// The same of the next frame of a view: where the picture stands still (StillSegments, by `threshold` grey levels; 0:
// nowhere) segments stay what they are in `before`, elsewhere they grow anew (RegrowSnic). The prior is not made.
// Errors as RegrowSnic.
[[nodiscard]] Result<ViewAnalysis> AnalyseNextView(YcbcrImage picture, const ViewAnalysis& before, int threshold,
                                                   double compactness, const std::stop_token& stop = {});

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_H_
