#ifndef DEPTHFARM_COMMON_QUALITY_PSNR_H_
#define DEPTHFARM_COMMON_QUALITY_PSNR_H_

#include <cstdint>

#include "common/image/picture.h"
#include "common/quality/masks.h"

namespace depthfarm {

// Sum of squared differences of luma, in full-range 8-bit units.
struct LumaError {
  double squared_sum = 0;
  std::int64_t pixels = 0;

  void Add(const LumaError& other) {
    squared_sum += other.squared_sum;
    pixels += other.pixels;
  }
};

// Over the pixels where `counted` is set (all if null). The pictures and the mask have one size.
[[nodiscard]] LumaError MeasureLumaError(const YcbcrImage& a, const YcbcrImage& b, const PixelMask* counted = nullptr);

// PSNR-Y in dB as video is judged: luma scaled to 16-235 (BT.601, x 219/255, unrounded), peak 255. Infinite for equal
// pictures, NaN for no pixels. 1.32 dB above the full-range figure.
[[nodiscard]] double PsnrVideoRange(const LumaError& error);

// PSNR-Y in dB of full-range luma, peak 255.
[[nodiscard]] double PsnrFullRange(const LumaError& error);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_PSNR_H_
