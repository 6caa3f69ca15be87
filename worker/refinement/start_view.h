#ifndef DEPTHFARM_WORKER_REFINEMENT_START_VIEW_H_
#define DEPTHFARM_WORKER_REFINEMENT_START_VIEW_H_

#include <span>

#include "worker/refinement/plane_field.h"
#include "worker/segmentation/analysis.h"

namespace depthfarm {

// One frame that a P frame refers to (paper III-E), of the same view.
struct RefinedReference {
  const ViewAnalysis* analysis = nullptr;
  const RefinedView* refined = nullptr;  // after its last round
};

// Where refinement starts: each segment has the plane given for it, nothing is kept.
[[nodiscard]] RefinedView StartView(const SegmentMap& segments, std::span<const SlantedPlane> plane_of_segment);

// The unchanged segments of a P frame (FindUnchanged) take over the refined depth of their reference, pixel by pixel:
// what stands still has the same depth in every frame of a GOP, to the bit. Pixels where the reference has the depth of
// something else, which moved away, have that under their segment's centre.
void KeepUnchanged(const ViewAnalysis& analysis, const RefinedReference& previous, const RefinedReference& i_frame,
                   int p_threshold, int i_threshold, RefinedView& view);

// A segment that is not kept takes the refined plane of what the frame before shows there or up to 8 pixels away, of
// those that are at its centre within `reach` (one a segment, pixels of u: a level) of its own plane, which is that of
// its level: the one of which the segment's colour is most alike, the first row by row of several; none: it stays.
// Surfaces move little from frame to frame, so most planes need no more than a round or two.
void StartFromAround(const SegmentMap& segments, const RefinedReference& previous, std::span<const double> reach,
                     RefinedView& view);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_START_VIEW_H_
