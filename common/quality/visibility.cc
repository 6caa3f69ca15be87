#include "common/quality/visibility.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/reprojection.h"

namespace depthfarm {
namespace {

constexpr double kSameSurfaceLevels = 4;
constexpr double kVisibilityLevels = 1;

}  // namespace

double LevelIndex(const DepthLevels& levels, double depth_in_ref) {
  const double far_inverse = 1.0 / levels.z_far();
  const double near_inverse = 1.0 / levels.z_near();
  return (1.0 / depth_in_ref - far_inverse) / (near_inverse - far_inverse) * (levels.count() - 1);
}

std::optional<double> SurfaceLevelAt(const ViewDepth& view, const LevelsInView& levels_in_view,
                                     const DepthLevels& levels, double x, double y, double expected) {
  const DepthMap& depth = *view.depth;
  const double cx = std::clamp(x, 0.0, static_cast<double>(depth.width() - 1));
  const double cy = std::clamp(y, 0.0, static_cast<double>(depth.height() - 1));
  const int x0 = static_cast<int>(cx);
  const int y0 = static_cast<int>(cy);
  const double tx = cx - x0;
  const double ty = cy - y0;

  double lowest = 0;
  double highest = 0;
  double inverse = 0;
  std::optional<double> closest;
  bool all_known = true;
  bool first = true;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const int px = std::min(x0 + i, depth.width() - 1);
      const int py = std::min(y0 + j, depth.height() - 1);
      const double z = static_cast<double>(depth(px, py));
      const double depth_in_ref = z > 0 ? levels_in_view.DepthInRef(px, py, z) : 0;
      if (!(depth_in_ref > 0)) {
        all_known = false;
        continue;
      }
      const double level = LevelIndex(levels, depth_in_ref);
      if (!closest || std::abs(level - expected) < std::abs(*closest - expected)) closest = level;
      lowest = first ? level : std::min(lowest, level);
      highest = first ? level : std::max(highest, level);
      first = false;
      inverse += (i == 0 ? 1 - tx : tx) * (j == 0 ? 1 - ty : ty) / z;
    }
  }
  if (!all_known) return closest;
  const double depth_in_ref = levels_in_view.DepthInRef(cx, cy, 1.0 / inverse);
  if (!(depth_in_ref > 0)) return closest;
  const double between = LevelIndex(levels, depth_in_ref);
  const bool one_surface = highest - lowest <= kSameSurfaceLevels;
  return one_surface || std::abs(between - expected) < std::abs(*closest - expected) ? between : *closest;
}

PixelMask VisibleInAny(const ViewDepth& view, const std::vector<ViewDepth>& others, const DepthLevels& levels) {
  const DepthMap& depth = *view.depth;
  const LevelsInView in_view(view.camera, levels);
  PixelMask visible(depth.width(), depth.height());
  for (const ViewDepth& other : others) {
    const Reprojection other_from_view(view.camera, other.camera);
    const LevelsInView in_other(other.camera, levels);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        const double z = static_cast<double>(depth(x, y));
        if (!(z > 0) || visible(x, y) != 0) continue;
        const double depth_in_ref = in_view.DepthInRef(x, y, z);
        const Reprojection::Projected p = other_from_view.Project(x, y, 1.0 / z);
        if (!(depth_in_ref > 0) || !(p.depth_per_source > 0)) continue;
        if (!(p.x >= -0.5 && p.y >= -0.5 && p.x <= other.camera.width - 0.5 && p.y <= other.camera.height - 0.5)) {
          continue;
        }
        const double level = LevelIndex(levels, depth_in_ref);
        const std::optional<double> surface = SurfaceLevelAt(other, in_other, levels, p.x, p.y, level);
        if (!surface || *surface <= level + kVisibilityLevels) visible(x, y) = 1;
      }
    }
  }
  return visible;
}

}  // namespace depthfarm
