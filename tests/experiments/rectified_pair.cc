#include "tests/experiments/rectified_pair.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace depthfarm {
namespace {

struct Box {
  double min_x = std::numeric_limits<double>::infinity();
  double max_x = -std::numeric_limits<double>::infinity();
  double min_y = std::numeric_limits<double>::infinity();
  double max_y = -std::numeric_limits<double>::infinity();
};

std::array<Eigen::Vector3d, 5> CornersAndCentre(const Camera& camera) {
  const double w = camera.width - 1;
  const double h = camera.height - 1;
  return {{{0, 0, 1}, {w, 0, 1}, {0, h, 1}, {w, h, 1}, {w / 2, h / 2, 1}}};
}

}  // namespace

Result<RectifiedPair> Rectify(const Camera& first, const Camera& second, const DepthRange& range,
                              int most_disparities) {
  const Eigen::Vector3d baseline = CenterInWorld(second) - CenterInWorld(first);
  const double length = baseline.norm();
  const Eigen::Vector3d axis =
      (first.cam_from_world_rotation.row(2) + second.cam_from_world_rotation.row(2)).transpose();
  const Eigen::Vector3d x = baseline / length;
  const Eigen::Vector3d z = axis - axis.dot(x) * x;
  if (!(length > 0) || !(z.norm() > 0.3 * axis.norm())) {
    return InvalidArgument("cameras '" + first.name + "' and '" + second.name + "' cannot be rectified");
  }
  Eigen::Matrix3d rotation;  // rectified from world
  rotation.row(0) = x.transpose();
  rotation.row(2) = z.normalized().transpose();
  rotation.row(1) = Eigen::Vector3d(z.normalized().cross(x)).transpose();

  const Eigen::Matrix3d ray_of_first =
      rotation * first.cam_from_world_rotation.transpose() * first.intrinsics.inverse();
  const Eigen::Matrix3d ray_of_second =
      rotation * second.cam_from_world_rotation.transpose() * second.intrinsics.inverse();
  const double focal =
      0.25 * (first.intrinsics(0, 0) + first.intrinsics(1, 1) + second.intrinsics(0, 0) + second.intrinsics(1, 1));
  Box box;
  double near = 0;
  double far = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& pixel : CornersAndCentre(first)) {
    const Eigen::Vector3d ray = ray_of_first * pixel;
    if (!(ray.z() > 0.1)) {
      return InvalidArgument("camera '" + first.name + "' looks along its baseline to '" + second.name + "'");
    }
    box.min_x = std::min(box.min_x, focal * ray.x() / ray.z());
    box.max_x = std::max(box.max_x, focal * ray.x() / ray.z());
    box.min_y = std::min(box.min_y, focal * ray.y() / ray.z());
    box.max_y = std::max(box.max_y, focal * ray.y() / ray.z());
    near = std::max(near, focal * length / (range.z_near * ray.z()));
    far = std::min(far, focal * length / (range.z_far * ray.z()));
  }
  RectifiedPair pair;
  const double needed = std::ceil(std::min(near - far, static_cast<double>(most_disparities)));
  pair.disparities = std::min((static_cast<int>(needed) + 3 + 15) / 16 * 16, most_disparities / 16 * 16);
  // The matcher finds nothing in its first `disparities` columns: they are left empty.
  const double first_x = pair.disparities + 1 - box.min_x;
  const double row = -box.min_y;
  pair.width = static_cast<int>(std::ceil(box.max_x - box.min_x)) + 2 + pair.disparities;
  pair.height = static_cast<int>(std::ceil(box.max_y - box.min_y)) + 1;
  // x1 - x2 = focal length / Z + first_x - second_x, 1 at the farthest.
  pair.offset = 1 - far;
  const double second_x = first_x - pair.offset;
  const auto intrinsics = [&](double column) {
    Eigen::Matrix3d k;
    k << focal, 0, column, 0, focal, row, 0, 0, 1;
    return k;
  };
  pair.first = intrinsics(first_x) * ray_of_first;
  pair.second = intrinsics(second_x) * ray_of_second;
  pair.scale = 1 / (focal * length);
  pair.ray_z = ray_of_first.row(2);
  return pair;
}

}  // namespace depthfarm
