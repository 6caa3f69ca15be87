#ifndef DEPTHFARM_WORKER_REFINEMENT_REGION_PARTS_H_
#define DEPTHFARM_WORKER_REFINEMENT_REGION_PARTS_H_

#include <span>
#include <vector>

#include "worker/refinement/plane_field.h"
#include "worker/refinement/region_fit.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Segments of a region that lie on a plane of their own.
struct RegionPart {
  SlantedPlane plane;
  std::vector<SegmentIndex> segments;
};

// Not in the paper (docs/method.md, section 8). A region may be several surfaces that look alike, as a floor and the
// wall behind it. What little texture they have tells nothing in a window of a match or a segment, but it does in tiles
// of a few hundred pixels. Where many tiles in a row fit several times worse than the region usually does, and several
// times better somewhere nearer, most of their pixels (at an edge, of what is hidden in other views, few do), a plane
// is fitted to them; what continues them and fits better by it is a part. Farther parts are not looked for: what is
// behind the surfaces around may be hidden where it does not fit.
//
// `region`: its segments, with the planes that were decided for them in `planes` (per segment of the view); `pixels`:
// its pixels; `judged`: those of them that tell how deep it is. The parts in a fixed order; later ones hold segments of
// earlier ones where they fit better yet.
[[nodiscard]] std::vector<RegionPart> FindNearerParts(const RegionFit& fit, const SegmentMap& segments,
                                                      std::span<const SegmentIndex> region,
                                                      std::span<const PixelPosition> pixels,
                                                      std::span<const PixelPosition> judged,
                                                      std::span<const SlantedPlane> planes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_REGION_PARTS_H_
