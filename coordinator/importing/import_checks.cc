#include "coordinator/importing/import_checks.h"

#include <algorithm>
#include <sstream>

#include "common/geometry/neighbours.h"

namespace depthfarm {
namespace {

constexpr int kSomeLevels = 16;      // only their middle and ends matter here
constexpr double kSamePlace = 1e-9;  // of the nearest depth

std::string RangeText(const DepthRange& range) {
  std::ostringstream text;
  text << range.z_near << " to " << range.z_far;
  return text.str();
}

}  // namespace

Result<ArrayOverview> LookAtArray(const std::vector<Camera>& cameras, std::size_t reference, const DepthRange& range) {
  const Camera& center = cameras[reference];
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthLevels levels,
                             DepthLevels::Create(center, range.z_near, range.z_far, kSomeLevels));
  ArrayOverview overview;
  if (cameras.size() < 2) return overview;
  double farthest = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (i == reference) continue;
    const double distance = (CenterInWorld(cameras[i]) - CenterInWorld(center)).norm();
    farthest = std::max(farthest, distance);
    if (!overview.nearest.empty() && distance >= overview.baseline) continue;
    overview.nearest = cameras[i].name;
    overview.baseline = distance;
  }
  if (farthest <= kSamePlace * range.z_near) {
    return InvalidArgument("all cameras are at one place, from which there is no depth to tell");
  }
  overview.disparity_near = center.intrinsics(0, 0) * overview.baseline / range.z_near;
  overview.disparity_far = center.intrinsics(0, 0) * overview.baseline / range.z_far;
  const std::vector<std::vector<int>> neighbours = ChooseNeighbours(cameras, levels, 2);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (neighbours[i].empty()) overview.lonely.push_back(cameras[i].name);
  }
  if (overview.lonely.size() == cameras.size()) {
    return InvalidArgument("no two cameras see the same part of the scene at depths of " + RangeText(range) +
                           " before camera '" + center.name + "'");
  }
  return overview;
}

}  // namespace depthfarm
