#ifndef DEPTHFARM_COMMON_GEOMETRY_CAMERA_PATH_H_
#define DEPTHFARM_COMMON_GEOMETRY_CAMERA_PATH_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"

namespace depthfarm {

// A smooth way of a virtual camera through real ones.
class CameraPath {
 public:
  // kInvalidArgument: fewer than two stops, or stops of different size (both are said).
  [[nodiscard]] static Result<CameraPath> Create(std::vector<Camera> stops);

  // The camera at `position` in [0, stops - 1], clamped; a whole number is that stop. The centre follows a Catmull-Rom
  // spline (a straight line between two stops), the rotation the shortest way, K goes linearly. `name` is the caller's.
  [[nodiscard]] Camera At(double position, const std::string& name) const;

  // `count` >= 1 cameras at equal steps of `position` from the first stop to the last, named "view 0", "view 1",
  // ...; one alone stands in the middle.
  [[nodiscard]] std::vector<Camera> Sample(int count) const;

 private:
  explicit CameraPath(std::vector<Camera> stops) : stops_(std::move(stops)) {}

  std::vector<Camera> stops_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_CAMERA_PATH_H_
