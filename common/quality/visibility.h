#ifndef DEPTHFARM_COMMON_QUALITY_VISIBILITY_H_
#define DEPTHFARM_COMMON_QUALITY_VISIBILITY_H_

#include <optional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"
#include "common/image/picture.h"
#include "common/quality/masks.h"

namespace depthfarm {

// A view and a depth map of it (exact or estimated). Borrowed; the map has the camera's size.
struct ViewDepth {
  const DepthMap* depth = nullptr;
  Camera camera;
};

// Fractional index of the level plane at `depth_in_ref` (DepthLevels' spacing, uniform in inverse depth, continued
// beyond its ends): 0 at z_far, count - 1 at z_near. `depth_in_ref` > 0.
[[nodiscard]] double LevelIndex(const DepthLevels& levels, double depth_in_ref);

// Level of the surface that `view` shows at the sub-pixel position (x, y) inside its picture: 1/z interpolated between
// the four pixels around it if they form one surface (levels at most 4 apart). Else it is a steep surface or an
// outline, where the position could be on either side: of the four and the value between them, the level nearest to
// `expected`. Empty where there is no depth, or it lies behind the reference camera.
[[nodiscard]] std::optional<double> SurfaceLevelAt(const ViewDepth& view, const LevelsInView& levels_in_view,
                                                   const DepthLevels& levels, double x, double y, double expected);

// Pixels of `view` whose exact point is seen by at least one of `others`: it falls inside the picture and the exact
// surface there isn't nearer by more than one level. All depths exact. Pixels without depth aren't set.
[[nodiscard]] PixelMask VisibleInAny(const ViewDepth& view, const std::vector<ViewDepth>& others,
                                     const DepthLevels& levels);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_VISIBILITY_H_
