#include "worker/cost/matching.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "worker/cost/energy_units.h"

namespace depthfarm {

WindowDifference WindowColorDifference(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center,
                                       PixelPosition target, int window) {
  const int radius = window / 2;
  const int left = -std::min({radius, center.x, target.x});
  const int right = std::min({radius, view.width() - 1 - center.x, neighbour.width() - 1 - target.x});
  const int top = -std::min({radius, center.y, target.y});
  const int bottom = std::min({radius, view.height() - 1 - center.y, neighbour.height() - 1 - target.y});
  WindowDifference result;
  for (int dy = top; dy <= bottom; ++dy) {
    const Ycbcr* a = view.row(center.y + dy) + center.x;
    const Ycbcr* b = neighbour.row(target.y + dy) + target.x;
    for (int dx = left; dx <= right; ++dx) result.sum += L1Distance(a[dx], b[dx]);
  }
  result.samples = (right - left + 1) * (bottom - top + 1);
  return result;
}

std::uint16_t MatchReward(const WindowDifference& difference, std::int32_t offset_steps) {
  const std::int32_t mean_steps = difference.sum * kMatchStepsPerGrey / difference.samples;
  return static_cast<std::uint16_t>(std::max(0, offset_steps - mean_steps));
}

std::int32_t MatchOffsetSteps(double matching_offset) {
  return static_cast<std::int32_t>(std::llround(matching_offset * kMatchStepsPerGrey));
}

MatchGeometry::MatchGeometry(const Camera& view, const Camera& neighbour, const DepthLevels& levels)
    : in_view_(view, levels),
      neighbour_from_view_(view, neighbour),
      neighbour_width_(neighbour.width),
      neighbour_height_(neighbour.height) {
  for (int level = 0; level < levels.count(); ++level) depth_in_ref_.push_back(levels.DepthInRef(level));
}

std::optional<PixelPosition> MatchGeometry::Target(PixelPosition center, Level level) const {
  const double inverse = in_view_.InverseDepth(center.x, center.y, depth_in_ref_[level]);
  if (!(inverse > 0)) return std::nullopt;
  return TargetAt(center, inverse);
}

std::optional<PixelPosition> MatchGeometry::TargetOnPlane(PixelPosition center, double inverse_depth_in_ref) const {
  if (!in_view_.PlaneInFront(inverse_depth_in_ref)) return std::nullopt;
  return TargetAt(center, in_view_.InverseDepthOnPlane(center.x, center.y, inverse_depth_in_ref));
}

std::optional<PixelPosition> MatchGeometry::TargetAt(PixelPosition center, double inverse_depth) const {
  const Reprojection::Projected p = neighbour_from_view_.Project(center.x, center.y, inverse_depth);
  if (!(p.depth_per_source > 0)) return std::nullopt;
  // Compared before the conversion: a far away point does not fit an int.
  if (!(p.x >= -0.5) || !(p.y >= -0.5) || !(p.x < neighbour_width_ - 0.5) || !(p.y < neighbour_height_ - 0.5)) {
    return std::nullopt;
  }
  return PixelPosition{static_cast<std::int32_t>(std::floor(p.x + 0.5)),
                       static_cast<std::int32_t>(std::floor(p.y + 0.5))};
}

}  // namespace depthfarm
