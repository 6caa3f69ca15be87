#include "common/geometry/camera_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>

namespace depthfarm {
namespace {

std::string Size(const Camera& camera) { return std::to_string(camera.width) + "x" + std::to_string(camera.height); }

// Uniform Catmull-Rom between b (t = 0) and c (t = 1).
Eigen::Vector3d Spline(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d, double t) {
  const Eigen::Vector3d out_of_b = 0.5 * (c - a);
  const Eigen::Vector3d into_c = 0.5 * (d - b);
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * b + (t3 - 2 * t2 + t) * out_of_b + (3 * t2 - 2 * t3) * c + (t3 - t2) * into_c;
}

}  // namespace

Result<CameraPath> CameraPath::Create(std::vector<Camera> stops) {
  if (stops.size() < 2) return InvalidArgument("a path needs at least two cameras");
  for (const Camera& stop : stops) {
    DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(stop));
    if (stop.width != stops.front().width || stop.height != stops.front().height) {
      return InvalidArgument("cameras on a path must have one size: '" + stops.front().name + "' is " +
                             Size(stops.front()) + ", '" + stop.name + "' " + Size(stop));
    }
  }
  return CameraPath(std::move(stops));
}

Camera CameraPath::At(double position, const std::string& name) const {
  const std::size_t last = stops_.size() - 1;
  const double clamped = std::clamp(position, 0.0, static_cast<double>(last));
  const std::size_t i = std::min(static_cast<std::size_t>(clamped), last - 1);
  const double t = clamped - static_cast<double>(i);
  const Camera& from = stops_[i];
  const Camera& to = stops_[i + 1];
  Camera camera = t < 1 ? from : to;
  camera.name = name;
  if (t == 0 || t == 1) return camera;  // to the bit
  const Eigen::Vector3d b = CenterInWorld(from);
  const Eigen::Vector3d c = CenterInWorld(to);
  const Eigen::Vector3d a = i > 0 ? CenterInWorld(stops_[i - 1]) : Eigen::Vector3d(2 * b - c);
  const Eigen::Vector3d d = i + 2 <= last ? CenterInWorld(stops_[i + 2]) : Eigen::Vector3d(2 * c - b);
  const Eigen::Quaterniond turn_from(from.cam_from_world_rotation);
  const Eigen::Quaterniond turn_to(to.cam_from_world_rotation);
  camera.cam_from_world_rotation = turn_from.slerp(t, turn_to).normalized().toRotationMatrix();
  camera.cam_from_world_translation = -(camera.cam_from_world_rotation * Spline(a, b, c, d, t));
  camera.intrinsics = (1 - t) * from.intrinsics + t * to.intrinsics;
  return camera;
}

std::vector<Camera> CameraPath::Sample(int count) const {
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<std::size_t>(std::max(count, 0)));
  const auto length = static_cast<double>(stops_.size() - 1);
  for (int i = 0; i < count; ++i)
    cameras.push_back(At(count > 1 ? length * i / (count - 1) : 0.5 * length, "view " + std::to_string(i)));
  return cameras;
}

}  // namespace depthfarm
