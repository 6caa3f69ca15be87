#ifndef DEPTHFARM_COMMON_CALIBRATION_PICTURE_SIZE_H_
#define DEPTHFARM_COMMON_CALIBRATION_PICTURE_SIZE_H_

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// The camera for the same pictures at another size, e.g. reduced ones: f' = f s, c' = (c + 0.5) s - 0.5 for each side.
// kInvalidArgument, naming the camera: the shape is another one, by more than a pixel of rounding.
[[nodiscard]] Result<Camera> CameraOfSize(const Camera& camera, const PictureSize& size);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_PICTURE_SIZE_H_
