#ifndef DEPTHFARM_COMMON_IMAGE_COLOUR_H_
#define DEPTHFARM_COMMON_IMAGE_COLOUR_H_

#include <array>

#include "common/image/picture.h"

namespace depthfarm {

// A colour in floating point: what is computed with. Four values, so that it is one vector register.
using Colour = std::array<float, 4>;  // Y, Cb, Cr, matte in grey levels (8-bit units)

[[nodiscard]] inline Colour ColourOf(const Ycbcr& pixel) {
  return {static_cast<float>(pixel.y), static_cast<float>(pixel.cb), static_cast<float>(pixel.cr),
          static_cast<float>(pixel.matte)};
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_IMAGE_COLOUR_H_
