#ifndef DEPTHFARM_TESTS_SUPPORT_PLANE_SCENE_H_
#define DEPTHFARM_TESTS_SUPPORT_PLANE_SCENE_H_

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/image/picture.h"

namespace depthfarm {

// A plane with a smooth texture of its world X and Y, cut off at two world X.
struct TexturedPlane {
  Eigen::Vector3d point = Eigen::Vector3d(0, 0, 10);
  Eigen::Vector3d normal = Eigen::Vector3d(0, 0, 1);
  double min_x = -std::numeric_limits<double>::infinity();
  double max_x = std::numeric_limits<double>::infinity();
  double base = 128;      // mean luma
  double amplitude = 60;  // of the texture
  double frequency = 1;   // waves per unit of length, roughly
};

struct PlaneView {
  Camera camera;
  YcbcrImage picture;
  DepthMap depth;
};

// A camera at world (x, y, 0) that looks along +z, principal point in the middle.
[[nodiscard]] Camera ForwardCamera(const std::string& name, double x, double y, int width, int height, double focal_px);

// What the camera sees: the nearest plane on each pixel's ray, sampled at the pixel's centre, its exact depth; a pixel
// without any plane is black and has depth 0.
[[nodiscard]] PlaneView RenderPlanes(const Camera& camera, const std::vector<TexturedPlane>& planes);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_SUPPORT_PLANE_SCENE_H_
