#include "tests/support/plane_scene.h"

#include <algorithm>
#include <cmath>

namespace depthfarm {

Camera ForwardCamera(const std::string& name, double x, double y, int width, int height, double focal_px) {
  Camera camera;
  camera.name = name;
  camera.width = width;
  camera.height = height;
  camera.intrinsics << focal_px, 0, (width - 1) / 2.0, 0, focal_px, (height - 1) / 2.0, 0, 0, 1;
  camera.cam_from_world_translation = Eigen::Vector3d(-x, -y, 0);
  return camera;
}

PlaneView RenderPlanes(const Camera& camera, const std::vector<TexturedPlane>& planes) {
  PlaneView view{camera, YcbcrImage(camera.width, camera.height), DepthMap(camera.width, camera.height)};
  const Eigen::Vector3d center = CenterInWorld(camera);
  const Eigen::Matrix3d inverse = InverseIntrinsics(camera.intrinsics);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.cam_from_world_rotation.transpose() * (inverse * Eigen::Vector3d(x, y, 1));
      double nearest = std::numeric_limits<double>::infinity();
      for (const TexturedPlane& plane : planes) {
        const double z = plane.normal.dot(plane.point - center) / plane.normal.dot(ray);
        const Eigen::Vector3d p = center + z * ray;
        if (!(z > 0) || z >= nearest || p[0] < plane.min_x || p[0] > plane.max_x) continue;
        nearest = z;
        const double wave = std::sin(6.2831853 * plane.frequency * p[0] + p[1]) *
                            std::cos(6.2831853 * plane.frequency * 0.7 * p[1] - 0.5 * p[0]);
        view.picture(x, y).y =
            static_cast<std::uint8_t>(std::lround(std::clamp(plane.base + plane.amplitude * wave, 0.0, 255.0)));
        view.depth(x, y) = static_cast<float>(z);
      }
    }
  }
  return view;
}

}  // namespace depthfarm
