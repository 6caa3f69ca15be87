#ifndef DEPTHFARM_WORKER_TEMPORAL_UNCHANGED_H_
#define DEPTHFARM_WORKER_TEMPORAL_UNCHANGED_H_

#include <vector>

#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Where a segment of a P frame takes its depth from (paper III-E).
enum class DepthSource : std::uint8_t {
  kEstimated,  // it changed: a node of the graph
  kPrevious,   // unchanged since the previous frame: all components of its mean colour changed by less than T_P
  kIFrame,     // unchanged since the GOP's I frame: by less than T_I
};

struct AdoptedSegment {
  DepthSource source = DepthSource::kEstimated;
  SegmentIndex collocated = 0;  // segment of that reference whose depth is adopted
};

// Compares each segment of one view with its collocated segments in the two reference frames of the same view.
// Collocated (open in the paper, segmentation being made anew for each frame): the reference's segment under the
// segment's centre. Where both conditions hold the I frame wins, T_I being the stricter: its depth never drifts. All
// maps are of one view, equal in size. Thresholds in grey levels; 0 = nothing is unchanged by that condition.
[[nodiscard]] std::vector<AdoptedSegment> FindUnchanged(const SegmentMap& current, const SegmentMap& previous,
                                                        const SegmentMap& i_frame, int p_threshold, int i_threshold);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TEMPORAL_UNCHANGED_H_
