#ifndef DEPTHFARM_TESTS_EXPERIMENTS_RECTIFIED_PAIR_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_RECTIFIED_PAIR_H_

#include <Eigen/Core>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"

namespace depthfarm {

// Two cameras turned so that their rows match: the x axis of both is the baseline from the first to the second, so the
// disparity x1 - x2 is positive for everything in front, whatever side the second camera is on (the pictures of a left
// neighbour are upside down, which no matcher minds).
struct RectifiedPair {
  Eigen::Matrix3d first;   // rectified pixel = H pixel, homogeneous
  Eigen::Matrix3d second;  //
  int width = 0;           // of both rectified pictures: nothing of the first is cut off
  int height = 0;
  int disparities = 0;  // the range's disparities lie in [1, disparities), a multiple of 16
  // 1 / (the first camera's own z) of a pixel of the first with disparity d: (d - offset) * scale * r_z, r_z the third
  // component of `ray_z` (x, y, 1).
  double offset = 0;
  double scale = 0;
  Eigen::RowVector3d ray_z;
};

// `range`: of the first camera's own z; its nearest part is cut off where it needs more than `most_disparities` (OpenCV
// holds 2047).
// kInvalidArgument: cameras in one place, or that look along their baseline.
[[nodiscard]] Result<RectifiedPair> Rectify(const Camera& first, const Camera& second, const DepthRange& range,
                                            int most_disparities = 2032);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_RECTIFIED_PAIR_H_
