#include "common/quality/bjontegaard.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace depthfarm {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Status Check(const std::vector<RatePoint>& curve, const char* name) {
  if (curve.size() < 4) {
    return InvalidArgument("Bjøntegaard delta: the " + std::string(name) + " curve has " +
                           std::to_string(curve.size()) + " points, expected at least 4");
  }
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (!(curve[i].bits > 0) || !std::isfinite(curve[i].bits) || !std::isfinite(curve[i].psnr)) {
      return InvalidArgument("Bjøntegaard delta: point " + std::to_string(i) + " of the " + name + " curve is " +
                             std::to_string(curve[i].bits) + " bits at " + std::to_string(curve[i].psnr) + " dB");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (curve[i].psnr == curve[j].psnr) {
        return InvalidArgument("Bjøntegaard delta: two points of the " + std::string(name) + " curve have " +
                               std::to_string(curve[i].psnr) + " dB");
      }
    }
  }
  return {};
}

Range PsnrRange(const std::vector<RatePoint>& curve) {
  Range range;
  for (const RatePoint& point : curve) {
    range.low = std::min(range.low, point.psnr);
    range.high = std::max(range.high, point.psnr);
  }
  return range;
}

// Integral over `range` of the cubic that fits log10(bits) as a function of PSNR. PSNR is taken relative to the middle
// of the range: powers of 40 dB would cost the fit half its digits.
double IntegralOfLogBits(const std::vector<RatePoint>& curve, const Range& range) {
  const double middle = (range.low + range.high) / 2;
  const auto count = static_cast<Eigen::Index>(curve.size());
  Eigen::MatrixXd powers(count, 4);
  Eigen::VectorXd log_bits(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const RatePoint& point = curve[static_cast<std::size_t>(i)];
    const double d = point.psnr - middle;
    powers.row(i) << 1, d, d * d, d * d * d;
    log_bits(i) = std::log10(point.bits);
  }
  const Eigen::Vector4d cubic = powers.colPivHouseholderQr().solve(log_bits);
  const double h = (range.high - range.low) / 2;
  return 2 * (cubic(0) * h + cubic(2) * h * h * h / 3);  // odd powers cancel
}

}  // namespace

Result<double> BjontegaardRatePercent(const std::vector<RatePoint>& anchor, const std::vector<RatePoint>& tested) {
  DEPTHFARM_RETURN_IF_ERROR(Check(anchor, "anchor's"));
  DEPTHFARM_RETURN_IF_ERROR(Check(tested, "tested"));
  const Range a = PsnrRange(anchor);
  const Range b = PsnrRange(tested);
  const Range common = {std::max(a.low, b.low), std::min(a.high, b.high)};
  if (!(common.high > common.low)) {
    return InvalidArgument("Bjøntegaard delta: the anchor's curve covers " + std::to_string(a.low) + " to " +
                           std::to_string(a.high) + " dB, the tested one " + std::to_string(b.low) + " to " +
                           std::to_string(b.high) + ": nothing in common");
  }
  const double difference = IntegralOfLogBits(tested, common) - IntegralOfLogBits(anchor, common);
  return 100 * (std::pow(10.0, difference / (common.high - common.low)) - 1);
}

}  // namespace depthfarm
