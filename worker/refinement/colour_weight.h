#ifndef DEPTHFARM_WORKER_REFINEMENT_COLOUR_WEIGHT_H_
#define DEPTHFARM_WORKER_REFINEMENT_COLOUR_WEIGHT_H_

#include <array>
#include <cstddef>
#include <cstdlib>

#include "common/image/picture.h"

namespace depthfarm {
namespace colour_weight_internal {

inline constexpr double kFalloff = 40;  // grey levels, summed over the components

// Of each difference that two pixels can have.
inline constexpr auto kWeights = [] {
  std::array<double, 4 * 255 + 1> weights{};
  for (std::size_t d = 0; d < weights.size(); ++d) {
    const double base = 1 / (1 + static_cast<double>(d) / kFalloff);
    weights[d] = base * base * base * base;
  }
  return weights;
}();

}  // namespace colour_weight_internal

// Summed over all components, grey levels.
[[nodiscard]] inline int ColourDifference(const Ycbcr& a, const Ycbcr& b) {
  return L1Distance(a, b) + std::abs(a.matte - b.matte);
}

// How alike two colours are, 1 to more than 0. About exp(-d / 10) of the summed difference d of all components, without
// the library's exp, whose last bits differ between machines: (1 + d / 40)^-4.
[[nodiscard]] inline double ColourWeight(const Ycbcr& a, const Ycbcr& b) {
  return colour_weight_internal::kWeights[static_cast<std::size_t>(ColourDifference(a, b))];
}

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_COLOUR_WEIGHT_H_
