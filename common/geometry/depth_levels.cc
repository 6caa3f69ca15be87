#include "common/geometry/depth_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace depthfarm {

Result<DepthLevels> DepthLevels::Create(const Camera& reference, double z_near, double z_far, int count) {
  if (!std::isfinite(z_near) || !std::isfinite(z_far) || z_near <= 0 || z_near >= z_far) {
    std::ostringstream text;
    text << "depth range is zNear " << z_near << ", zFar " << z_far << ", expected 0 < zNear < zFar";
    return InvalidArgument(text.str());
  }
  if (count < 2 || count > kMaxLevels) {
    return InvalidArgument("levels is " + std::to_string(count) + ", expected 2 to " + std::to_string(kMaxLevels));
  }
  DepthLevels levels;
  levels.count_ = count;
  levels.z_near_ = z_near;
  levels.z_far_ = z_far;
  levels.axis_ = OpticalAxisInWorld(reference);
  levels.offset_ = reference.cam_from_world_translation[2];
  return levels;
}

double DepthLevels::DepthInRef(int level) const {
  const double far_inverse = 1.0 / z_far_;
  const double near_inverse = 1.0 / z_near_;
  return 1.0 / (far_inverse + (near_inverse - far_inverse) * (static_cast<double>(level) / (count_ - 1)));
}

LevelsInView::LevelsInView(const Camera& view, const DepthLevels& levels) {
  const Eigen::Matrix3d world_from_cam = view.cam_from_world_rotation.transpose();
  const Eigen::Matrix3d ray = OrderedProduct(world_from_cam, InverseIntrinsics(view.intrinsics));
  slope_x_ = OrderedDot(levels.axis_in_world(), ray.col(0));
  slope_y_ = OrderedDot(levels.axis_in_world(), ray.col(1));
  slope_1_ = OrderedDot(levels.axis_in_world(), ray.col(2));
  center_depth_ = levels.DepthInRefOf(CenterInWorld(view));
}

Result<DepthRange> OwnDepthRange(const Camera& view, const DepthLevels& levels) {
  constexpr double kNearestShare = 1.0 / 20;
  const LevelsInView in_view(view, levels);
  int nearest_in_front = levels.count() - 1;
  while (nearest_in_front > 0 && levels.DepthInRef(nearest_in_front) <= in_view.center_depth()) --nearest_in_front;
  DepthRange range{std::numeric_limits<double>::infinity(), 0};
  const auto visit = [&](int x, int y) {
    for (const int level : {0, nearest_in_front}) {
      const double inverse = in_view.InverseDepth(x, y, levels.DepthInRef(level));
      if (!(inverse > 0) || !std::isfinite(inverse)) continue;
      range.z_near = std::min(range.z_near, 1.0 / inverse);
      range.z_far = std::max(range.z_far, 1.0 / inverse);
    }
  };
  for (int x = 0; x < view.width; ++x) {
    visit(x, 0);
    visit(x, view.height - 1);
  }
  for (int y = 0; y < view.height; ++y) {
    visit(0, y);
    visit(view.width - 1, y);
  }
  range.z_near = std::max(range.z_near, kNearestShare * levels.z_near());
  const bool looks_back = OrderedDot(OpticalAxisInWorld(view), levels.axis_in_world()) <= 0;
  if (looks_back || !(range.z_near < range.z_far) || !std::isfinite(range.z_far)) {
    return InvalidArgument("camera '" + view.name +
                           "' does not see the depth planes of the reference camera (it faces away from them or stands "
                           "behind them): leave it out with --views, or choose another reference");
  }
  return range;
}

}  // namespace depthfarm
