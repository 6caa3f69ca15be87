#include "common/calibration/robust_range.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace depthfarm {
namespace {

constexpr std::size_t kFewestPoints = 20;
constexpr double kOutliers = 0.01;   // of the points at either end
constexpr double kNearMargin = 0.1;  // of the inverse depth at that end
constexpr double kFarMargin = 0.2;

}  // namespace

Result<DepthRange> RobustRange(std::vector<float> depths) {
  std::erase_if(depths, [](float z) { return !(z > 0) || !std::isfinite(z); });
  if (depths.size() < kFewestPoints) {
    return InvalidArgument("sees " + std::to_string(depths.size()) + " points, too few to tell the depth range from");
  }
  const auto at = [&](double share) {
    const auto position = static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), depths.begin() + position, depths.end());
    return static_cast<double>(depths[static_cast<std::size_t>(position)]);
  };
  const DepthRange range{.z_near = at(kOutliers) / (1 + kNearMargin), .z_far = at(1 - kOutliers) / (1 - kFarMargin)};
  return range;
}

}  // namespace depthfarm
