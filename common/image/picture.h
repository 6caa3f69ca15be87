#ifndef DEPTHFARM_COMMON_IMAGE_PICTURE_H_
#define DEPTHFARM_COMMON_IMAGE_PICTURE_H_

#include <cstdint>

#include "common/image/grid.h"

namespace depthfarm {

// One pixel: full-range BT.601 Y'CbCr in 8-bit units at any source depth (design: K, T_P, T_I are in these units).
// Four bytes, so that a pixel is one aligned word; `pad` is always 0.
struct Ycbcr {
  std::uint8_t y = 0;
  std::uint8_t cb = 128;
  std::uint8_t cr = 128;
  std::uint8_t pad = 0;
  bool operator==(const Ycbcr&) const = default;
};

// A view's picture at full chroma resolution.
using YcbcrImage = Grid<Ycbcr>;

// R'G'B' of 8 bits each: what a renderer makes and what people look at.
struct Rgb8 {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb8&) const = default;
};

using RgbImage = Grid<Rgb8>;

// z along the view's own optical axis in the sequence's unit of length, > 0; 0 = no depth.
using DepthMap = Grid<float>;

// Which zone of a rendered scene each pixel shows (Zone values of common/scene/zone.h).
using ZoneMap = Grid<std::uint8_t>;

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_IMAGE_PICTURE_H_
