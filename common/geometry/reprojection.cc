#include "common/geometry/reprojection.h"

namespace depthfarm {

Reprojection::Reprojection(const Camera& source, const Camera& target) {
  const Eigen::Matrix3d world_from_source = source.cam_from_world_rotation.transpose();
  const Eigen::Matrix3d target_from_source = OrderedProduct(target.cam_from_world_rotation, world_from_source);
  m_ = OrderedProduct(OrderedProduct(target.intrinsics, target_from_source), InverseIntrinsics(source.intrinsics));
  const Eigen::Vector3d center = OrderedProduct(target.cam_from_world_rotation, CenterInWorld(source));
  const Eigen::Vector3d center_in_target = center + target.cam_from_world_translation;
  e_ = OrderedProduct(target.intrinsics, center_in_target);
}

}  // namespace depthfarm
