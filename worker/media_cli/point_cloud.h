#ifndef DEPTHFARM_WORKER_MEDIA_CLI_POINT_CLOUD_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_POINT_CLOUD_H_

#include <cstddef>
#include <string>

#include "common/geometry/camera.h"
#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// Which pixels become points.
struct PointChoice {
  int step = 1;  // every so many columns and rows
  // Where not empty: confidence of the depth, probability times 65535, and the least of it.
  const Grid<std::uint16_t>* confidence = nullptr;
  std::uint16_t least = 0;
};

// Points of a picture with depth, in the world: X = R^T (z K^-1 (x, y, 1) - t), the sequence's unit of length.
class PointCloud {
 public:
  // Of all pixels that are chosen and have depth (z > 0, along the camera's axis). Sizes are the camera's.
  void Add(const Camera& camera, const DepthMap& depth, const YcbcrImage& picture, const PointChoice& choice);

  [[nodiscard]] std::size_t num_points() const { return num_points_; }
  // Binary little-endian PLY: x y z as floats, red green blue as bytes (BT.601, full range). Equal points give equal
  // bytes.
  [[nodiscard]] std::string Ply() const;

 private:
  std::string points_;  // as in the file
  std::size_t num_points_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_POINT_CLOUD_H_
