#include "common/calibration/picture_size.h"

#include <cmath>
#include <string>

namespace depthfarm {

Result<Camera> CameraOfSize(const Camera& camera, const PictureSize& size) {
  const double across = static_cast<double>(size.width) / camera.width;
  const double down = static_cast<double>(size.height) / camera.height;
  if (std::abs(camera.height * across - size.height) > 1 && std::abs(camera.width * down - size.width) > 1) {
    return InvalidArgument("camera '" + camera.name + "' was calibrated for pictures of " +
                           std::to_string(camera.width) + "x" + std::to_string(camera.height) + ": those of " +
                           std::to_string(size.width) + "x" + std::to_string(size.height) +
                           " have another shape, expected the same pictures larger or smaller");
  }
  Camera result = camera;
  result.width = size.width;
  result.height = size.height;
  Eigen::Matrix3d& k = result.intrinsics;
  k(0, 0) *= across;
  k(0, 1) *= across;
  k(1, 1) *= down;
  k(0, 2) = (k(0, 2) + 0.5) * across - 0.5;
  k(1, 2) = (k(1, 2) + 0.5) * down - 0.5;
  return result;
}

}  // namespace depthfarm
