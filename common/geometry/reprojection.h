#ifndef DEPTHFARM_COMMON_GEOMETRY_REPROJECTION_H_
#define DEPTHFARM_COMMON_GEOMETRY_REPROJECTION_H_

#include <Eigen/Core>

#include "common/geometry/camera.h"

namespace depthfarm {

// T[.] of eq. (4): where a pixel of `source` at a given own depth appears in `target`.
//   (qx, qy, qz) = M (x, y, 1) + e / z,  M = K' R' R^T K^-1,  e = K' (R' C + t'),  target pixel = (qx, qy) / qz;
//   target depth z' = z * qz.
class Reprojection {
 public:
  Reprojection(const Camera& source, const Camera& target);

  struct Projected {
    double x = 0;  // target pixel, (0, 0) the centre of the top-left one
    double y = 0;
    double depth_per_source = 0;  // z' / z; <= 0 means behind the target camera: x, y are meaningless then
  };

  // (x, y) in pixels of the source, inverse_depth = 1/z > 0 along the source's own axis.
  [[nodiscard]] Projected Project(double x, double y, double inverse_depth) const {
    const double qx = m_(0, 0) * x + m_(0, 1) * y + m_(0, 2) + e_[0] * inverse_depth;
    const double qy = m_(1, 0) * x + m_(1, 1) * y + m_(1, 2) + e_[1] * inverse_depth;
    const double qz = m_(2, 0) * x + m_(2, 1) * y + m_(2, 2) + e_[2] * inverse_depth;
    return {qx / qz, qy / qz, qz};
  }

  [[nodiscard]] const Eigen::Matrix3d& m() const { return m_; }  // M
  [[nodiscard]] const Eigen::Vector3d& e() const { return e_; }

 private:
  Eigen::Matrix3d m_;
  Eigen::Vector3d e_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_REPROJECTION_H_
