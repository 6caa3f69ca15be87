#ifndef DEPTHFARM_COMMON_CALIBRATION_LLFF_H_
#define DEPTHFARM_COMMON_CALIBRATION_LLFF_H_

#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// poses_bounds.npy of LLFF (B. Mildenhall et al., SIGGRAPH 2019): a row of 17 numbers for each picture, in the order of
// the pictures' names: a 3x5 matrix row by row, whose columns are the camera's axes in the world, down, right and
// BACKWARDS, its centre, and (height, width, focal length in pixels); then its nearest and farthest depth. The
// principal point is the middle of the picture.
//
// `pictures`: names of the picture files in their order, which name the cameras too; empty: they are called "000",
// "001", ... and have no picture. `file` is for messages.
// Errors  kInvalidArgument naming file, row and camera: those of ParseNpy, another number of columns, of pictures than
//         rows, a size that is no whole number of pixels, a pose or range that is none.
[[nodiscard]] Result<Calibration> ParseLlffCameras(std::string_view bytes, const std::string& file,
                                                   const std::vector<std::string>& pictures);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_LLFF_H_
