#ifndef DEPTHFARM_COMMON_CALIBRATION_MIV_H_
#define DEPTHFARM_COMMON_CALIBRATION_MIV_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// The camera JSON of MPEG immersive video (TMIV, RVS, IVDE): {"cameras": [{"Name", "Projection": "Perspective",
// "Position": [x, y, z], "Rotation": [yaw, pitch, roll], "Resolution": [w, h], "Focal": [fx, fy], "Principle_point":
// [cx, cy], "Depth_range": [near, far]}], "Fps"}; other keys are passed over. Axes of world and camera are those of
// OMAF, x forward, y left, z up; degrees, X = Rz(yaw) Ry(pitch) Rx(roll) x_cam + Position. The principal point counts
// from the corner of the top-left pixel, half a pixel more than here. The world stays as it is, the camera's axes
// become x right, y down, z forward. A camera called "viewport" is a viewer's and left out.
//
// A depth range is that of the camera. `file` is for messages.
// Errors  kInvalidArgument naming file, camera and key: no such JSON, a projection that is not perspective, a camera
//         that is there twice, values that are none of a camera.
[[nodiscard]] Result<Calibration> ParseMivCameras(std::string_view text, const std::string& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_MIV_H_
