#ifndef DEPTHFARM_COMMON_MEDIA_GROUND_TRUTH_H_
#define DEPTHFARM_COMMON_MEDIA_GROUND_TRUTH_H_

#include <cstdint>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// What is known of one view in one frame. Sizes are those of the camera.
struct GroundTruthFrame {
  DepthMap depth;                  // z along the view's own axis, 0 = unknown
  ZoneMap zones;                   // empty when the sequence gives none
  Grid<std::uint8_t> nonoccluded;  // 1 = counted as visible in the neighbour; empty when the sequence gives none
};

// Loads frame `frame` (a position of the lists; sets of measured disparity have only 0) of a view of width x height.
//
//   kDepthPfm: the file's z. kDisparityPfm: z = scale / (value + offset). kDisparityPng: z = scale / (value / divisor +
//   offset), value 0 = unknown. A value that is not finite, or whose z is not > 0, is unknown.
// Errors  kInvalidArgument naming the file: another size, damaged, a frame beyond the list (names the view).
[[nodiscard]] Result<GroundTruthFrame> ReadGroundTruth(const GroundTruthView& view, int frame, int width, int height);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_GROUND_TRUTH_H_
