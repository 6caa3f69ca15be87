#ifndef DEPTHFARM_COMMON_GEOMETRY_SYMMETRIC_SOLVE_H_
#define DEPTHFARM_COMMON_GEOMETRY_SYMMETRIC_SOLVE_H_

#include <array>
#include <cmath>

namespace depthfarm {

// Cholesky factor L of a symmetric positive definite H (aa ab ac bb bc cc): plain operations in a stated order, so the
// same bits everywhere.
class SymmetricFactor {
 public:
  SymmetricFactor() = default;  // of nothing
  explicit SymmetricFactor(const std::array<double, 6>& h)
      : inverse00_(1 / std::sqrt(h[0])),
        l10_(h[1] * inverse00_),
        l20_(h[2] * inverse00_),
        inverse11_(1 / std::sqrt(h[3] - l10_ * l10_)),
        l21_((h[4] - l20_ * l10_) * inverse11_),
        inverse22_(1 / std::sqrt(h[5] - l20_ * l20_ - l21_ * l21_)) {}

  // Whether H is definite, so that Solve means something.
  [[nodiscard]] bool definite() const { return Usable(inverse00_) && Usable(inverse11_) && Usable(inverse22_); }

  // p of H p = r.
  [[nodiscard]] std::array<double, 3> Solve(const std::array<double, 3>& r) const {
    const double y0 = r[0] * inverse00_;
    const double y1 = (r[1] - l10_ * y0) * inverse11_;
    const double y2 = (r[2] - l20_ * y0 - l21_ * y1) * inverse22_;
    std::array<double, 3> p{};
    p[2] = y2 * inverse22_;
    p[1] = (y1 - l21_ * p[2]) * inverse11_;
    p[0] = (y0 - l10_ * p[1] - l20_ * p[2]) * inverse00_;
    return p;
  }

 private:
  // Of an element of the diagonal; not so for a NaN, the root of a negative number.
  [[nodiscard]] static bool Usable(double inverse) { return inverse > 0 && inverse < 1e9; }

  double inverse00_ = 0;  // of the diagonal of L
  double l10_ = 0;
  double l20_ = 0;
  double inverse11_ = 0;
  double l21_ = 0;
  double inverse22_ = 0;
};

// Solves H p = r once. false, and p as it was, where H is not definite.
[[nodiscard]] inline bool SolveSymmetric(const std::array<double, 6>& h, const std::array<double, 3>& r,
                                         std::array<double, 3>& p) {
  const SymmetricFactor factor(h);
  if (!factor.definite()) return false;
  p = factor.Solve(r);
  return true;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_SYMMETRIC_SOLVE_H_
