#ifndef DEPTHFARM_COMMON_QUALITY_CONSISTENCY_H_
#define DEPTHFARM_COMMON_QUALITY_CONSISTENCY_H_

#include <cstdint>

#include "common/geometry/depth_levels.h"
#include "common/quality/masks.h"
#include "common/quality/visibility.h"

namespace depthfarm {

// Agreement of two views' depth. Raw sums, so that frames and directions add up.
struct AgreementFigures {
  std::int64_t in_view = 0;           // pixels of the one view that the other can judge
  std::int64_t in_view_agreeing = 0;  // of these, within one level of the other's surface
  std::int64_t non_occluded = 0;
  std::int64_t non_occluded_agreeing = 0;
  double level_difference_sum = 0;  // |difference| over the non-occluded pixels

  void Add(const AgreementFigures& other);
  [[nodiscard]] double InViewPercent() const;  // NaN where nothing can be judged
  [[nodiscard]] double NonOccludedPercent() const;
  [[nodiscard]] double MeanLevelDifference() const;
};

// Each pixel of `view` is put into `other` by its depth; it counts where it lands inside and there is depth, and agrees
// if its level and that of the surface there (SurfaceLevelAt) differ by at most one.
// Non-occluded pixels: with `exactly_visible` (VisibleInAny of the exact depths of the two views) those set there;
// without (null) those in front of which `other` shows nothing nearer by more than one level, so that only a pixel
// nearer than what the other view shows can disagree: a lower bound of the true disagreement.
[[nodiscard]] AgreementFigures MeasureAgreement(const ViewDepth& view, const ViewDepth& other,
                                                const DepthLevels& levels, const PixelMask* exactly_visible);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_CONSISTENCY_H_
