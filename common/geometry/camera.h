#ifndef DEPTHFARM_COMMON_GEOMETRY_CAMERA_H_
#define DEPTHFARM_COMMON_GEOMETRY_CAMERA_H_

#include <Eigen/Core>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// A pinhole camera without distortion: x_cam = rotation * X_world + translation, x right, y down, z forward;
// pixel = K * x_cam / z with (0, 0) at the centre of the top-left pixel.
struct Camera {
  std::string name;                                                       // also a file name
  int width = 0;                                                          // pixels
  int height = 0;                                                         // pixels
  Eigen::Matrix3d intrinsics = Eigen::Matrix3d::Identity();               // K, upper triangular, pixels
  Eigen::Matrix3d cam_from_world_rotation = Eigen::Matrix3d::Identity();  // R
  Eigen::Vector3d cam_from_world_translation = Eigen::Vector3d::Zero();   // t, the sequence's unit of length
  bool operator==(const Camera&) const = default;
};

// Checks sizes (1..32768 a side), K (finite, upper triangular, positive focal lengths, last row 0 0 1) and R
// (orthonormal to 1e-3, determinant +1). kInvalidArgument names the camera, the value and the bound.
[[nodiscard]] Status ValidateCamera(const Camera& camera);

// C = -R^T t.
[[nodiscard]] Eigen::Vector3d CenterInWorld(const Camera& camera);

// Third row of R: the direction of the optical axis in the world.
[[nodiscard]] Eigen::Vector3d OpticalAxisInWorld(const Camera& camera);

// The camera of a picture `factor` times smaller (floor of the size): c' = (c + 0.5) / factor - 0.5, f' = f / factor.
[[nodiscard]] Camera Downscaled(const Camera& camera, int factor);

// Determinism: the products below add in one stated order without fused operations, so that every machine gets the same
// bits; Eigen's own products may not (it uses explicit FMA on some targets). Geometry that reaches depth uses only
// these.
[[nodiscard]] Eigen::Vector3d OrderedProduct(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
[[nodiscard]] Eigen::Matrix3d OrderedProduct(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);
[[nodiscard]] double OrderedDot(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
// Inverse of an upper triangular K with last row 0 0 1.
[[nodiscard]] Eigen::Matrix3d InverseIntrinsics(const Eigen::Matrix3d& k);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_CAMERA_H_
