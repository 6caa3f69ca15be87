#ifndef DEPTHFARM_WORKER_SEGMENTATION_STILL_SEGMENTS_H_
#define DEPTHFARM_WORKER_SEGMENTATION_STILL_SEGMENTS_H_

#include <cstdint>
#include <vector>

#include "common/image/picture.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Which segments of a view can stay what they are in its next frame: 1 for each where the picture stands still, of the
// segment and of all that are adjacent to it, else 0. It stands still where at each pixel the mean of every component
// over the 3 x 3 pixels around (those at a border counted again beyond it) changes by less than `threshold` grey
// levels: a mean, because the noise of single pixels would leave few segments. Adjacent ones, because what moves must
// find room for its contour: without them views lose 0.08 dB. `before` and `now` have the size of the segments. Work
// O(pixels).
[[nodiscard]] std::vector<std::uint8_t> StillSegments(const SegmentMap& segments, const YcbcrImage& before,
                                                      const YcbcrImage& now, int threshold);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_STILL_SEGMENTS_H_
