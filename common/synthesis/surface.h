#ifndef DEPTHFARM_COMMON_SYNTHESIS_SURFACE_H_
#define DEPTHFARM_COMMON_SYNTHESIS_SURFACE_H_

#include <cstdint>

#include "common/geometry/camera.h"
#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// What a source view's depth map is in the eyes of a target view: a sheet of points, torn where the depth jumps.
struct Surface {
  // Bits of `flags`.
  static constexpr std::uint8_t kTornRight = 1;   // not connected to the pixel on the right (or there is none)
  static constexpr std::uint8_t kTornBelow = 2;   // not connected to the pixel below (or there is none)
  static constexpr std::uint8_t kBehindEdge = 4;  // on the far side of a jump one pixel away: its colour may be mixed
  static constexpr std::uint8_t kSmooth = 8;      // pixels (x - 1 .. x + 2, y - 1 .. y + 2) exist and are all connected

  // Where each pixel's point is in the target; source size.
  Grid<float> x;  // pixel of the target
  Grid<float> y;
  Grid<float> target_inverse_depth;  // 1/z' along the target's axis; 0 = no depth, or behind the target

  Grid<float> inverse_depth;  // 1/z along the source's own axis; 0 where there is no point
  Grid<float> parallax;       // how many target pixels a point moves per unit of its own 1/z
  Grid<std::uint8_t> flags;
};

struct SurfaceParams {
  // Two neighbouring pixels belong to one surface if the difference of their depths moves a point by at most this many
  // target pixels, or if the depth goes on in a straight line (1/z of a plane is linear in the pixel) up to
  // `max_straight_step_px`.
  double max_step_px = 1.0;
  double max_straight_step_px = 6.0;
};

// `depth` has the size of `source`.
[[nodiscard]] Surface ProjectSurface(const DepthMap& depth, const Camera& source, const Camera& target,
                                     const SurfaceParams& params = {});

// Draws the surface into a target of the given size with a z-buffer: triangles between connected pixels, and at tears
// and picture borders each pixel's own square, so that neither cracks nor shrunken outlines appear.
// Result: 1/z' of the nearest surface at each target pixel; 0 = nothing.
[[nodiscard]] Grid<float> RenderInverseDepth(const Surface& surface, int width, int height);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SYNTHESIS_SURFACE_H_
