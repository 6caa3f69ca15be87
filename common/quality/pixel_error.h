#ifndef DEPTHFARM_COMMON_QUALITY_PIXEL_ERROR_H_
#define DEPTHFARM_COMMON_QUALITY_PIXEL_ERROR_H_

#include <string>

#include "common/base/status.h"
#include "common/geometry/reprojection.h"
#include "common/image/grid.h"
#include "common/quality/depth_error.h"

namespace depthfarm {

struct PixelError {
  bool estimated = false;
  double levels = 0;
  double px = 0;
};

// Error of single pixels of one view, as MeasureDepthError defines it. The input must have passed CheckErrorInput and
// outlive this.
class PixelErrors {
 public:
  explicit PixelErrors(const DepthErrorInput& input);

  // Whether the truth is known here, in front of the reference camera and of the neighbour.
  [[nodiscard]] bool Known(int x, int y) const;
  // Of a pixel of known truth.
  [[nodiscard]] PixelError At(int x, int y) const;

 private:
  const DepthErrorInput& input_;
  LevelsInView in_view_;
  Reprojection neighbour_from_view_;
};

// kInvalidArgument: missing inputs, or sizes that differ from the camera's.
[[nodiscard]] Status CheckErrorInput(const DepthErrorInput& input);

// kInvalidArgument, naming the camera and `what`, unless `grid` (null: none) has the camera's size.
template <typename T>
[[nodiscard]] Status CheckGridSize(const Grid<T>* grid, const Camera& camera, const std::string& what) {
  if (grid == nullptr || (grid->width() == camera.width && grid->height() == camera.height)) return {};
  return InvalidArgument("view '" + camera.name + "': the " + what + " is " + std::to_string(grid->width()) + "x" +
                         std::to_string(grid->height()) + ", the camera " + std::to_string(camera.width) + "x" +
                         std::to_string(camera.height));
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_PIXEL_ERROR_H_
