#ifndef DEPTHFARM_COMMON_QUALITY_BJONTEGAARD_H_
#define DEPTHFARM_COMMON_QUALITY_BJONTEGAARD_H_

#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// One point of a rate-distortion curve.
struct RatePoint {
  double bits = 0;  // > 0; per picture or per second: the same in all points that are compared
  double psnr = 0;  // dB
};

// Bjøntegaard delta rate in percent: how many more bits `tested` takes than `anchor` at equal PSNR, below 0 = fewer
// (VCEG-M33, 2001): log10 of the bits as a cubic of the PSNR through the points (least squares of more than four), the
// difference integrated over the PSNR that both curves cover.
// Errors (kInvalidArgument): fewer than four points, bits <= 0 or values that aren't finite, two points of one curve
// with one PSNR, curves that have no PSNR in common.
[[nodiscard]] Result<double> BjontegaardRatePercent(const std::vector<RatePoint>& anchor,
                                                    const std::vector<RatePoint>& tested);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_BJONTEGAARD_H_
