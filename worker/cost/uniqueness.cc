#include "worker/cost/uniqueness.h"

#include <algorithm>
#include <cstddef>

namespace depthfarm {

std::vector<double> FloorPlanes(const DepthLevels& levels, double disparity_range) {
  const double far_inverse = 1.0 / levels.z_far();
  const double near_inverse = 1.0 / levels.z_near();
  constexpr double kLeastReach = 32;  // pixels
  const double stretch = disparity_range > 0 ? std::max(1.0, kLeastReach / disparity_range) : 1.0;
  std::vector<double> planes;
  for (int i = 0; i < kFloorPlanes; ++i) {
    const double share = 0.5 + stretch * ((i + 0.5) / kFloorPlanes - 0.5);
    planes.push_back(far_inverse + (near_inverse - far_inverse) * share);
  }
  return planes;
}

std::uint16_t RewardFloor(std::span<std::uint16_t> rewards, int percent) {
  const std::size_t before = (rewards.size() - 1) * static_cast<std::size_t>(percent) / 100;
  const auto floor = rewards.begin() + static_cast<std::ptrdiff_t>(before);
  std::nth_element(rewards.begin(), floor, rewards.end());
  return *floor;
}

}  // namespace depthfarm
