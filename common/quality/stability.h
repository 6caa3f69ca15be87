#ifndef DEPTHFARM_COMMON_QUALITY_STABILITY_H_
#define DEPTHFARM_COMMON_QUALITY_STABILITY_H_

#include <cstdint>

#include "common/geometry/depth_levels.h"
#include "common/quality/masks.h"
#include "common/quality/visibility.h"

namespace depthfarm {

// How much depth changes from one frame to the next where the picture does not. Raw sums: frames and views add up.
struct StabilityFigures {
  std::int64_t still = 0;           // pixels with depth in both frames whose colour did not change
  std::int64_t changed = 0;         // of these, with depth off by more than one level from the frame before
  double level_difference_sum = 0;  // |difference| over `still`

  void Add(const StabilityFigures& other);
  [[nodiscard]] double ChangedPercent() const;  // NaN where nothing is still
  [[nodiscard]] double MeanLevelDifference() const;
};

// Pixels whose colour did not change from one frame to the next: around them, over 7 x 7 pixels, the mean differences
// of Y, Cb and Cr (with their sign: noise averages out) add up to at most `threshold`, in full-range 8-bit units as
// T_P is. The pictures have one size.
[[nodiscard]] PixelMask StillPixels(const YcbcrImage& before, const YcbcrImage& now, double threshold = 3);

// Depth of one view in consecutive frames: `still` says which pixels count. All of one size.
[[nodiscard]] StabilityFigures MeasureStability(const DepthMap& before, const ViewDepth& now, const PixelMask& still,
                                                const DepthLevels& levels);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_STABILITY_H_
