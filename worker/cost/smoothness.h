#ifndef DEPTHFARM_WORKER_COST_SMOOTHNESS_H_
#define DEPTHFARM_WORKER_COST_SMOOTHNESS_H_

#include <cstdint>

#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// beta of eqs. (2) and (3): the cost, in energy units, of one level of difference between two adjacent segments,
//   beta = beta_0 / || mean colour of s - mean colour of t ||_1.
// Paper   III-D.
// Open in the paper, chosen here:
//   - the unit of |d_s - d_t|: levels counted in 1/249 of the depth range, whatever L is, so that beta_0 means the same
//     for 50 and for 250 levels (the paper has 250): beta is scaled by 249 / (L - 1);
//   - a distance of zero divides by zero: the distance is at least 1 grey level;
//   - eq. (1) read literally counts each pair {s, t} twice (s in S, t in T): here once, so beta_0 = 1 is the paper's
//   0.5
//     read that way;
//   - rounding: to the nearest even number of units, at least 2 while beta_0 > 0.
// Bound: with beta_0 <= 100, beta * (L - 1) <= 100 * 1152 * 249 < 2^25, so no capacity of a cut can overflow 32 bits.
class SmoothnessCost {
 public:
  // initial_smoothing: beta_0, 0..100; num_levels: L >= 2.
  SmoothnessCost(double initial_smoothing, int num_levels);

  [[nodiscard]] std::int32_t Beta(const MeanColor& s, const MeanColor& t) const;

 private:
  std::int64_t numerator_ = 0;  // half of beta times the distance in 1/64 grey
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_COST_SMOOTHNESS_H_
