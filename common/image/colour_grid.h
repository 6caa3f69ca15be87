#ifndef DEPTHFARM_COMMON_IMAGE_COLOUR_GRID_H_
#define DEPTHFARM_COMMON_IMAGE_COLOUR_GRID_H_

#include <array>
#include <cstddef>

#include "common/image/picture.h"

namespace depthfarm {

// A picture in floating point: what is sampled between pixels. Four values, so that a pixel is one vector register.
using Colour = std::array<float, 4>;  // Y, Cb, Cr, matte in grey levels (8-bit units)
using ColourGrid = Grid<Colour>;

[[nodiscard]] inline Colour ColourOf(const Ycbcr& pixel) {
  return {static_cast<float>(pixel.y), static_cast<float>(pixel.cb), static_cast<float>(pixel.cr),
          static_cast<float>(pixel.matte)};
}

[[nodiscard]] inline ColourGrid ColourOf(const YcbcrImage& picture) {
  ColourGrid grid(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i) grid.values()[i] = ColourOf(picture.values()[i]);
  return grid;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_IMAGE_COLOUR_GRID_H_
