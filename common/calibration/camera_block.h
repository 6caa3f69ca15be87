#ifndef DEPTHFARM_COMMON_CALIBRATION_CAMERA_BLOCK_H_
#define DEPTHFARM_COMMON_CALIBRATION_CAMERA_BLOCK_H_

#include <string>

#include "common/calibration/token_reader.h"

namespace depthfarm {

// What follows the name of a camera in the texts of FTV and MSR: three rows of K, two numbers of lens distortion, three
// rows of a pose.
struct CameraBlock {
  Eigen::Matrix3d intrinsics;
  TokenReader::Matrix34 pose;
};

// Errors  kInvalidArgument naming file, line and camera; also for distortion that is not 0.
[[nodiscard]] Result<CameraBlock> ReadCameraBlock(TokenReader& reader, const std::string& camera);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_CAMERA_BLOCK_H_
