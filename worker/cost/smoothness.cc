#include "worker/cost/smoothness.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "worker/cost/energy_units.h"

namespace depthfarm {
namespace {

constexpr double kPaperSteps = 249;  // |d_s - d_t| is counted in 1/249 of the range: the paper's 250 levels

}  // namespace

SmoothnessCost::SmoothnessCost(double initial_smoothing, int num_levels) {
  const double half_units = kEnergyUnitsPerGrey / 2.0 * kMeanColorScale;
  numerator_ = std::llround(initial_smoothing * half_units * kPaperSteps / (num_levels - 1));
  if (initial_smoothing > 0) numerator_ = std::max<std::int64_t>(numerator_, 1);
}

std::int32_t SmoothnessCost::Beta(const MeanColor& s, const MeanColor& t) const {
  if (numerator_ == 0) return 0;
  const std::int64_t floored = std::max<std::int64_t>(L1Distance(s, t), kMeanColorScale);
  const std::int64_t half = (numerator_ + floored / 2) / floored;
  return static_cast<std::int32_t>(2 * std::max<std::int64_t>(half, 1));
}

}  // namespace depthfarm
