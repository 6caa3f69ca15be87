#ifndef DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_
#define DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_

#include "common/image/colour_grid.h"

namespace depthfarm {

// Smoothed by a Gaussian of one pixel (1 4 6 4 1, borders repeated).
[[nodiscard]] ColourGrid Blurred(const ColourGrid& colours);

// Bilinear; (x, y) must lie in [0, W - 1] x [0, H - 1].
[[nodiscard]] inline Colour SampleAt(const ColourGrid& grid, double x, double y) {
  const int x0 = x >= grid.width() - 1 ? grid.width() - 2 : static_cast<int>(x);
  const int y0 = y >= grid.height() - 1 ? grid.height() - 2 : static_cast<int>(y);
  const auto fx = static_cast<float>(x - x0);
  const auto fy = static_cast<float>(y - y0);
  const Colour* top = grid.row(y0) + x0;
  const Colour* bottom = grid.row(y0 + 1) + x0;
  Colour result;
  for (int i = 0; i < 4; ++i) {
    const float upper = top[0][i] + fx * (top[1][i] - top[0][i]);
    const float lower = bottom[0][i] + fx * (bottom[1][i] - bottom[0][i]);
    result[i] = upper + fy * (lower - upper);
  }
  return result;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_
