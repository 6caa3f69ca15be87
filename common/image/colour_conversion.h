#ifndef DEPTHFARM_COMMON_IMAGE_COLOUR_CONVERSION_H_
#define DEPTHFARM_COMMON_IMAGE_COLOUR_CONVERSION_H_

#include <algorithm>
#include <cstdint>

#include "common/image/picture.h"

namespace depthfarm {

// Colour at full precision: Y' in 0..255, Cb and Cr around 0 (no 128 added).
struct YcbcrReal {
  double y = 0;
  double cb = 0;
  double cr = 0;
};

// Nearest, halves up, clamped to 0..255.
[[nodiscard]] inline std::uint8_t RoundedToByte(double value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));  // cut off: the floor of what is not negative
}

// To 8-bit units. The one rounding of a picture's samples.
[[nodiscard]] inline Ycbcr RoundedTo8Bit(const YcbcrReal& colour) {
  return {RoundedToByte(colour.y), RoundedToByte(colour.cb + 128), RoundedToByte(colour.cr + 128), 0};
}

// R'G'B' (0..255) to full-range BT.601 Y'CbCr: Y' = 0.299 R + 0.587 G + 0.114 B, Cb = (B - Y') / 1.772,
// Cr = (R - Y') / 1.402, in this order of operations (the JFIF formulas).
[[nodiscard]] inline YcbcrReal Bt601FromRgb(double r, double g, double b) {
  const double y = 0.299 * r + 0.587 * g + 0.114 * b;
  return {y, (b - y) / 1.772, (r - y) / 1.402};
}

// Full-range BT.709 to full-range BT.601 over R'G'B', which is not clipped on the way.
[[nodiscard]] inline YcbcrReal Bt601FromBt709(const YcbcrReal& bt709) {
  const double r = bt709.y + 1.5748 * bt709.cr;
  const double b = bt709.y + 1.8556 * bt709.cb;
  const double g = (bt709.y - 0.2126 * r - 0.0722 * b) / 0.7152;
  return Bt601FromRgb(r, g, b);
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_IMAGE_COLOUR_CONVERSION_H_
