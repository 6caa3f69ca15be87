#ifndef DEPTHFARM_COMMON_QUALITY_IV_PSNR_H_
#define DEPTHFARM_COMMON_QUALITY_IV_PSNR_H_

#include "common/image/picture.h"

namespace depthfarm {

// IV-PSNR in dB (Dziembowski, Mieloch, Stankowski, Grzelka 2022), MPEG immersive video's measure: PSNR that forgives
// what no viewer of a virtual view notices.
//   - A pixel is compared with the best of the 5 x 5 around its place in the other picture (squared differences of
//     Y, Cb, Cr weighted 4 : 1 : 1).
//   - The mean difference of each component, at most 1 % of its range, is taken out first.
//   - PSNR of Y, Cb and Cr, weighted 4 : 1 : 1; from `a` to `b` and back, the lower one.
// Samples are taken in 16-235 (BT.601, rounded to 8 bits) at full chroma resolution, peak 255. A component without any
// error counts as one with a squared error of 1 in all, so that the figure stays finite. The pictures have one size;
// NaN if they are empty.
[[nodiscard]] double IvPsnr(const YcbcrImage& a, const YcbcrImage& b);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_IV_PSNR_H_
