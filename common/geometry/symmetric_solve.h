#ifndef DEPTHFARM_COMMON_GEOMETRY_SYMMETRIC_SOLVE_H_
#define DEPTHFARM_COMMON_GEOMETRY_SYMMETRIC_SOLVE_H_

#include <array>
#include <cmath>

namespace depthfarm {

// Solves H p = r for a symmetric positive definite H (aa ab ac bb bc cc) by its Cholesky factor: plain operations in a
// stated order, so the same bits everywhere. false, and p as it was, where H is not definite.
[[nodiscard]] inline bool SolveSymmetric(const std::array<double, 6>& h, const std::array<double, 3>& r,
                                         std::array<double, 3>& p) {
  const double l00 = std::sqrt(h[0]);
  const double l10 = h[1] / l00;
  const double l20 = h[2] / l00;
  const double l11 = std::sqrt(h[3] - l10 * l10);
  const double l21 = (h[4] - l20 * l10) / l11;
  const double l22 = std::sqrt(h[5] - l20 * l20 - l21 * l21);
  if (!(l00 > 1e-9 && l11 > 1e-9 && l22 > 1e-9)) return false;
  const double y0 = r[0] / l00;
  const double y1 = (r[1] - l10 * y0) / l11;
  const double y2 = (r[2] - l20 * y0 - l21 * y1) / l22;
  p[2] = y2 / l22;
  p[1] = (y1 - l21 * p[2]) / l11;
  p[0] = (y0 - l10 * p[1] - l20 * p[2]) / l00;
  return true;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_SYMMETRIC_SOLVE_H_
