#ifndef DEPTHFARM_TESTS_COMMON_CALIBRATION_EXPECT_CAMERA_H_
#define DEPTHFARM_TESTS_COMMON_CALIBRATION_EXPECT_CAMERA_H_

#include <gtest/gtest.h>

#include "common/geometry/camera.h"

namespace depthfarm {

inline Eigen::Matrix3d Rows(const Eigen::Vector3d& first, const Eigen::Vector3d& second, const Eigen::Vector3d& third) {
  Eigen::Matrix3d matrix;
  matrix.row(0) = first.transpose();
  matrix.row(1) = second.transpose();
  matrix.row(2) = third.transpose();
  return matrix;
}

// To rounding.
inline void ExpectPose(const Camera& camera, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  EXPECT_TRUE(camera.cam_from_world_rotation.isApprox(rotation, 1e-14)) << camera.name << "\n"
                                                                        << camera.cam_from_world_rotation;
  EXPECT_LT((camera.cam_from_world_translation - translation).norm(), 1e-14)
      << camera.name << "\n"
      << camera.cam_from_world_translation.transpose();
}

// R of "right" of the samples, whose t is (-1, 0, -2).
inline Eigen::Matrix3d TurnedRight() { return Rows({0.8, 0, -0.6}, {0, 1, 0}, {0.6, 0, 0.8}); }

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COMMON_CALIBRATION_EXPECT_CAMERA_H_
