#ifndef DEPTHFARM_COMMON_QUALITY_SSIM_H_
#define DEPTHFARM_COMMON_QUALITY_SSIM_H_

#include "common/image/picture.h"

namespace depthfarm {

// Mean structural similarity of full-range luma, in -1..1 (Wang, Bovik, Sheikh, Simoncelli 2004): Gaussian window of
// 11 x 11 pixels with sigma 1.5, K1 = 0.01, K2 = 0.03, peak 255, over the windows that lie inside the picture.
// The pictures have one size; NaN if a side is below 11 pixels.
[[nodiscard]] double Ssim(const YcbcrImage& a, const YcbcrImage& b);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_SSIM_H_
