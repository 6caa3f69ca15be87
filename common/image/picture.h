#ifndef DEPTHFARM_COMMON_IMAGE_PICTURE_H_
#define DEPTHFARM_COMMON_IMAGE_PICTURE_H_

#include <cstdint>
#include <cstdlib>

#include "common/image/grid.h"

namespace depthfarm {

// One pixel: full-range BT.601 Y'CbCr in 8-bit units at any source depth (design: K, T_P, T_I are in these units).
// Four bytes, so that a pixel is one aligned word.
struct Ycbcr {
  std::uint8_t y = 0;
  std::uint8_t cb = 128;
  std::uint8_t cr = 128;
  // Where a mask says what is foreground: 0 for the background to kForegroundMatte; 0 everywhere without a mask. A
  // fourth component where a picture's own pixels are told apart (segments, their borders, smoothness); not compared
  // between views, of which some may have no mask or one that is drawn otherwise.
  std::uint8_t matte = 0;
  bool operator==(const Ycbcr&) const = default;
};

inline constexpr int kForegroundMatte = 40;  // grey levels: a strong edge

// Sum of the differences of the colours, grey levels.
[[nodiscard]] inline int L1Distance(const Ycbcr& a, const Ycbcr& b) {
  return std::abs(a.y - b.y) + std::abs(a.cb - b.cb) + std::abs(a.cr - b.cr);
}

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
