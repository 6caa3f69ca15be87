#ifndef DEPTHFARM_TESTS_COMMON_GEOMETRY_PLAIN_GEOMETRY_H_
#define DEPTHFARM_TESTS_COMMON_GEOMETRY_PLAIN_GEOMETRY_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>
#include <string>

#include "common/geometry/camera.h"

namespace depthfarm {

// The textbook formulas, written with Eigen alone, that the code under test is compared with.

inline Eigen::Vector3d PointInCamera(const Camera& camera, const Eigen::Vector3d& point_in_world) {
  return camera.cam_from_world_rotation * point_in_world + camera.cam_from_world_translation;
}

// Pixel of a world point; its depth must not be 0.
inline Eigen::Vector2d PixelOf(const Camera& camera, const Eigen::Vector3d& point_in_world) {
  return (camera.intrinsics * PointInCamera(camera, point_in_world)).hnormalized();
}

// World point at depth z, along the camera's own axis, on the ray of pixel (x, y).
inline Eigen::Vector3d PointAt(const Camera& camera, double x, double y, double z) {
  const Eigen::Vector3d point_in_camera = z * (camera.intrinsics.inverse() * Eigen::Vector3d(x, y, 1));
  return camera.cam_from_world_rotation.inverse() * (point_in_camera - camera.cam_from_world_translation);
}

inline double Uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}

inline Eigen::Vector3d AnyDirection(std::mt19937_64& random) {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  while (direction.norm() < 0.1) {
    for (int i = 0; i < 3; ++i) direction[i] = Uniform(random, -1, 1);
  }
  return direction.normalized();
}

inline Eigen::Matrix3d AnyRotation(std::mt19937_64& random, double max_angle_rad) {
  return Eigen::AngleAxisd(Uniform(random, -max_angle_rad, max_angle_rad), AnyDirection(random)).toRotationMatrix();
}

// A camera with skew and unequal focal lengths that looks within `max_angle_rad` of the world's +z and stands within
// `max_step` of the world's origin along each axis. About 45 degrees wide.
inline Camera AnyCamera(std::mt19937_64& random, const std::string& name, double max_angle_rad, double max_step) {
  Camera camera;
  camera.name = name;
  camera.width = 24;
  camera.height = 16;
  camera.intrinsics << Uniform(random, 25, 35), Uniform(random, -2, 2), Uniform(random, 9, 15), 0,
      Uniform(random, 25, 35), Uniform(random, 6, 10), 0, 0, 1;
  camera.cam_from_world_rotation = AnyRotation(random, max_angle_rad);
  const Eigen::Vector3d center(Uniform(random, -max_step, max_step), Uniform(random, -max_step, max_step),
                               Uniform(random, -max_step, max_step));
  camera.cam_from_world_translation = -(camera.cam_from_world_rotation * center);
  return camera;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COMMON_GEOMETRY_PLAIN_GEOMETRY_H_
