#ifndef DEPTHFARM_TESTS_WORKER_REFINEMENT_TWO_VIEWS_H_
#define DEPTHFARM_TESTS_WORKER_REFINEMENT_TWO_VIEWS_H_

#include <cmath>
#include <cstdint>

#include "worker/refinement/other_view.h"

namespace depthfarm {

// A smooth texture over the plane, in pixels of the first view.
inline Ycbcr TextureAt(double x, double y) {
  const double value = 128 + 40 * std::sin(0.31 * x) + 35 * std::cos(0.23 * y + 0.2 * x);
  return {static_cast<std::uint8_t>(std::lround(value)), static_cast<std::uint8_t>(std::lround(100 + 0.2 * value)), 128,
          0};
}

// Two views side by side of a wall at a constant u: what is at (x, y) in the first is at (x - u, y) in the second,
// which may be of another size.
struct TwoViews {
  static constexpr int kWidth = 40;
  static constexpr int kHeight = 30;

  explicit TwoViews(double true_u, int other_width = kWidth, int other_height = kHeight)
      : own(kWidth, kHeight), there(other_width, other_height), there_map(other_width, other_height, float(true_u)) {
    pair.other = 1;
    pair.m = Eigen::Matrix3d::Identity();
    pair.e = {-1, 0, 0};
    pair.other_scale = 1;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) own(x, y) = TextureAt(x, y);
    for (int y = 0; y < other_height; ++y)
      for (int x = 0; x < other_width; ++x) there(x, y) = TextureAt(x + true_u, y);
  }
  TwoViews(const TwoViews&) = delete;
  TwoViews& operator=(const TwoViews&) = delete;

  [[nodiscard]] OtherView Other() const { return {.pair = &pair, .colour = there, .map = &there_map}; }

  PairGeometry pair;
  YcbcrImage own;
  YcbcrImage there;
  InverseDepthMap there_map;
};

// One segment over the whole first view, at a constant u.
inline RefinedView FlatView(double u) {
  return {.planes = {{0, 0, static_cast<float>(u)}},
          .kept = {0},
          .plane_of_pixel = Grid<PlaneIndex>(TwoViews::kWidth, TwoViews::kHeight)};
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_REFINEMENT_TWO_VIEWS_H_
