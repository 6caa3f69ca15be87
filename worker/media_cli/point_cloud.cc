#include "worker/media_cli/point_cloud.h"

#include <bit>
#include <cstdint>

#include "common/base/little_endian.h"
#include "common/media/colour_map.h"

namespace depthfarm {

void PointCloud::Add(const Camera& camera, const DepthMap& depth, const YcbcrImage& picture,
                     const PointChoice& choice) {
  const Eigen::Matrix3d inverse = InverseIntrinsics(camera.intrinsics);
  const Eigen::Matrix3d to_world = camera.cam_from_world_rotation.transpose();
  const RgbImage colours = ToRgb(picture);
  for (int y = 0; y < depth.height(); y += choice.step) {
    for (int x = 0; x < depth.width(); x += choice.step) {
      const float z = depth(x, y);
      if (!(z > 0) || (choice.confidence != nullptr && (*choice.confidence)(x, y) < choice.least)) continue;
      const Eigen::Vector3d ray = OrderedProduct(inverse, Eigen::Vector3d(x, y, 1));
      const Eigen::Vector3d point =
          OrderedProduct(to_world, Eigen::Vector3d(double{z} * ray - camera.cam_from_world_translation));
      for (const double coordinate : {point.x(), point.y(), point.z()})
        AppendU32(std::bit_cast<std::uint32_t>(static_cast<float>(coordinate)), points_);
      const Rgb8& colour = colours(x, y);
      for (const std::uint8_t sample : {colour.r, colour.g, colour.b}) points_.push_back(static_cast<char>(sample));
      ++num_points_;
    }
  }
}

std::string PointCloud::Ply() const {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(num_points_) +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" +
         points_;
}

}  // namespace depthfarm
