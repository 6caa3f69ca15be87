#ifndef DEPTHFARM_WORKER_REFINEMENT_PLAIN_REGIONS_H_
#define DEPTHFARM_WORKER_REFINEMENT_PLAIN_REGIONS_H_

#include <cstdint>
#include <span>
#include <vector>

#include "worker/refinement/picture_samples.h"
#include "worker/refinement/plane_field.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Per segment: 1 where the picture is so even around its centre that no depth matches better than another there.
// `smoothed`: the picture after Blurred.
[[nodiscard]] std::vector<std::uint8_t> PlainSegments(const FineImage& smoothed, const SegmentMap& segments);

// A surface without texture.
struct PlainRegion {
  // Plain ones of like colours, and their neighbours of about that colour and the same depth: what reaches over the
  // region's edge, where pictures tell how deep it is. None is kept, none is in two regions.
  std::vector<SegmentIndex> segments;
  std::vector<SegmentIndex> beside;  // all segments beside it, once for each that they touch
  std::vector<SegmentIndex> rim;     // those of them whose depth is known: not plain, or kept
  std::vector<SegmentIndex> behind;  // such ones beside the rim, as often as met
};

// The regions of at least 12 segments that have a rim. `view`: the depth they have, and what is kept.
[[nodiscard]] std::vector<PlainRegion> FindPlainRegions(const SegmentMap& segments, std::span<const std::uint8_t> plain,
                                                        const RefinedView& view);

// The depth of what may hide something: `map` without plain segments, for their depth is a guess, and spread by two
// pixels, for colours at the edges of what is thin are mixtures.
[[nodiscard]] InverseDepthMap Occluders(const InverseDepthMap& map, const Grid<SegmentIndex>& labels,
                                        std::span<const std::uint8_t> plain);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PLAIN_REGIONS_H_
