#include "worker/cost/matching.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "worker/cost/energy_units.h"
#include "worker/cost/match_kernels.h"

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

void MatchRewards(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center,
                  std::span<const PixelPosition> targets, int window, std::int32_t offset_steps,
                  std::span<std::uint16_t> rewards) {
  const bool on_vectors = window == 3 && HasWholeWindow(view, center);
  if (on_vectors) SumWindows3x3(view, neighbour, center, targets, offset_steps, rewards);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const PixelPosition target = targets[i];
    if (target == kNoTarget) {
      rewards[i] = 0;
    } else if (i > 0 && target == targets[i - 1]) {
      rewards[i] = rewards[i - 1];
    } else if (!on_vectors || !HasWholeWindow(neighbour, target)) {
      rewards[i] = MatchReward(WindowColorDifference(view, neighbour, center, target, window), offset_steps);
    }
  }
}

std::int32_t MatchOffsetSteps(double matching_offset) {
  return static_cast<std::int32_t>(std::llround(matching_offset * kMatchStepsPerGrey));
}

MatchGeometry::MatchGeometry(const Camera& view, const Camera& neighbour, const DepthLevels& levels)
    : in_view_(view, levels),
      neighbour_from_view_(view, neighbour),
      neighbour_width_(neighbour.width),
      neighbour_height_(neighbour.height) {
  for (int level = 0; level < levels.count(); ++level) {
    const double in_front = levels.DepthInRef(level) - in_view_.center_depth();
    per_slope_.push_back(in_front > 0 ? 1.0 / in_front : std::numeric_limits<double>::quiet_NaN());
  }
}

MatchGeometry::Planes MatchGeometry::PlanesOfLevels(std::span<const Level> levels) const {
  Planes planes;
  for (const Level level : levels) planes.push_back(per_slope_[level]);
  return planes;
}

MatchGeometry::Planes MatchGeometry::PlanesAt(std::span<const double> inverse_depths_in_ref) const {
  Planes planes;
  for (const double inverse : inverse_depths_in_ref) {
    planes.push_back(in_view_.PlaneInFront(inverse) ? in_view_.InversePerSlope(inverse)
                                                    : std::numeric_limits<double>::quiet_NaN());
  }
  return planes;
}

void MatchGeometry::Targets(PixelPosition center, std::span<const double> planes,
                            std::span<PixelPosition> targets) const {
  const Eigen::Matrix3d& m = neighbour_from_view_.m();
  const Eigen::Vector3d& e = neighbour_from_view_.e();
  EpipolarLine line;
  for (int i = 0; i < 3; ++i) {
    line.at_infinity[i] = m(i, 0) * center.x + m(i, 1) * center.y + m(i, 2);
    line.per_inverse_depth[i] = e[i];
  }
  line.slope = in_view_.Slope(center.x, center.y);
  if (!(line.slope > 0)) {  // the ray looks away from the planes
    std::fill(targets.begin(), targets.end(), kNoTarget);
    return;
  }
  line.width = neighbour_width_;
  line.height = neighbour_height_;
  ProjectOntoLine(line, planes, targets);
}

std::optional<PixelPosition> MatchGeometry::Target(PixelPosition center, Level level) const {
  const double inverse = in_view_.Slope(center.x, center.y) * per_slope_[level];
  if (!(inverse > 0)) return std::nullopt;
  return TargetAt(center, inverse);
}

std::optional<PixelPosition> MatchGeometry::TargetOnPlane(PixelPosition center, double inverse_depth_in_ref) const {
  if (!in_view_.PlaneInFront(inverse_depth_in_ref) || !(in_view_.Slope(center.x, center.y) > 0)) return std::nullopt;
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
