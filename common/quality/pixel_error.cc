#include "common/quality/pixel_error.h"

#include <cmath>

#include "common/quality/visibility.h"

namespace depthfarm {

PixelErrors::PixelErrors(const DepthErrorInput& input)
    : input_(input), in_view_(input.camera, *input.levels), neighbour_from_view_(input.camera, input.neighbour) {}

bool PixelErrors::Known(int x, int y) const {
  const double z = static_cast<double>((*input_.exact)(x, y));
  return z > 0 && std::isfinite(z) && in_view_.DepthInRef(x, y, z) > 0 &&
         neighbour_from_view_.Project(x, y, 1.0 / z).depth_per_source > 0;
}

PixelError PixelErrors::At(int x, int y) const {
  const double exact = static_cast<double>((*input_.exact)(x, y));
  const double z = static_cast<double>((*input_.estimated)(x, y));
  if (!(z > 0) || !std::isfinite(z)) return {};
  const double depth_in_ref = in_view_.DepthInRef(x, y, z);
  const Reprojection::Projected p = neighbour_from_view_.Project(x, y, 1.0 / z);
  if (!(depth_in_ref > 0) || !(p.depth_per_source > 0)) return {};
  const Reprojection::Projected q = neighbour_from_view_.Project(x, y, 1.0 / exact);
  PixelError error;
  error.estimated = true;
  const double level = LevelIndex(*input_.levels, depth_in_ref);
  error.levels = std::abs(level - LevelIndex(*input_.levels, in_view_.DepthInRef(x, y, exact)));
  error.px = std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y));
  return error;
}

Status CheckErrorInput(const DepthErrorInput& input) {
  if (input.estimated == nullptr || input.exact == nullptr || input.levels == nullptr) {
    return InvalidArgument("view '" + input.camera.name + "': depth, exact depth and levels are needed");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckGridSize(input.estimated, input.camera, "depth map"));
  DEPTHFARM_RETURN_IF_ERROR(CheckGridSize(input.exact, input.camera, "exact depth map"));
  DEPTHFARM_RETURN_IF_ERROR(CheckGridSize(input.non_occluded, input.camera, "mask of non-occluded pixels"));
  return CheckGridSize(input.zones, input.camera, "zone map");
}

}  // namespace depthfarm
