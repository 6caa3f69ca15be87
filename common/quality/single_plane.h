#ifndef DEPTHFARM_COMMON_QUALITY_SINGLE_PLANE_H_
#define DEPTHFARM_COMMON_QUALITY_SINGLE_PLANE_H_

#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"
#include "common/image/picture.h"
#include "common/quality/psnr.h"

namespace depthfarm {

// A real view without its depth.
struct PictureView {
  const YcbcrImage* picture = nullptr;  // borrowed, of the camera's size
  Camera camera;
};

// The picture `target` would take if the whole scene lay on the plane `depth_in_ref` of `levels`: the sources blended
// by nearness, bilinear; where no source reaches, their borders are continued.
[[nodiscard]] YcbcrImage SynthesizeOnPlane(const std::vector<PictureView>& sources, const Camera& target,
                                           const DepthLevels& levels, double depth_in_ref);

struct SinglePlane {
  double depth_in_ref = 0;
  YcbcrImage picture;
  LumaError error;  // of the whole picture
};

// What knowing nothing of the scene's shape is worth: of `planes` level planes, uniform in inverse depth over the
// range, the one whose synthesis is nearest to the real picture. Compared on every second pixel of every second row,
// the winner measured on all. Errors (kInvalidArgument): no source, sizes that differ, planes < 1.
[[nodiscard]] Result<SinglePlane> BestSinglePlane(const std::vector<PictureView>& sources, const PictureView& target,
                                                  const DepthLevels& levels, int planes = 64);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_SINGLE_PLANE_H_
