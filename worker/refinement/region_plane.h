#ifndef DEPTHFARM_WORKER_REFINEMENT_REGION_PLANE_H_
#define DEPTHFARM_WORKER_REFINEMENT_REGION_PLANE_H_

#include <span>
#include <stop_token>
#include <vector>

#include "worker/refinement/other_view.h"
#include "worker/refinement/plain_regions.h"
#include "worker/refinement/prior_field.h"

namespace depthfarm {

// Decides the depth of surfaces without texture, each as a whole. Segment by segment nothing tells how deep they are:
// the cut gives them any one level, for a plate pays only at its rim, and there the colour edge makes it cheap. All
// pixels of a region together do tell, by those along its edges: on a wrong plane they appear beside the edge in the
// other views. So a region takes the plane, of those around it or less than a pixel from the one through its rim, that
// fits the other views best, by the pixels that these see on both of two planes; of planes that fit alike, one that
// continues what lies around it on the far side. What varies already (a curved or slanted surface) needs evidence. With
// a prior (null: none) that field is one more of the planes: it wins where it fits about as well as the best and is
// trusted there, or fits clearly better. Parts of a region that lie nearer then take planes of their own, unless it
// takes the prior (worker/refinement/region_parts.h). `others`: their maps are Occluders. Ends early, with some regions
// not decided, once `stop` is requested.
void DecidePlainRegions(const PictureColours& own, const SegmentMap& segments, std::span<const PlainRegion> regions,
                        std::span<const OtherView> others, const PriorField* prior, RefinedView& view,
                        const std::stop_token& stop = {}, int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_REGION_PLANE_H_
