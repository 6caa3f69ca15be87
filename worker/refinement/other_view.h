#ifndef DEPTHFARM_WORKER_REFINEMENT_OTHER_VIEW_H_
#define DEPTHFARM_WORKER_REFINEMENT_OTHER_VIEW_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "worker/refinement/picture_samples.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {

// A colour difference of kKappa standard deviations counts half where planes are fitted: beyond, it tells of a
// silhouette. Where a pixel chooses between planes (Misfit) it does so at four times that: a pixel at a silhouette is a
// mixture that fits neither surface well, and the better one is to be told from the worse.
inline constexpr double kKappa = 3;
inline constexpr double kChoiceKappa = 12;

// Where a pixel at u appears in another view.
struct Seen {
  double x = 0;
  double y = 0;
  double u_in_other = 0;
  double dx = 0;  // dX / du, pixels per pixel of u
  double dy = 0;
};

// What of another view a view is compared with. All must outlive it.
struct OtherView {
  const PairGeometry* pair = nullptr;
  PictureColours colour;
  const InverseDepthMap* map = nullptr;
  double sigma = 1.5;  // of the colour differences, grey levels: MeasureNoise
};

inline constexpr double kHiddenBy = 1;  // pixels of u: a surface as much nearer hides a point, as much farther shows it

// The pixel of a position that is not negative; std::lround is a call.
[[nodiscard]] inline int NearestPixel(double position) {
  const double half_up = position + 0.5;
  return static_cast<int>(half_up);
}

// Where pixels of a view appear in another one; both x and y in one register. Refers to `other_map`.
class Sight {
 public:
  Sight(const PairGeometry& pair, const InverseDepthMap& other_map)
      : of_x_{pair.m(0, 0), pair.m(1, 0)},
        of_y_{pair.m(0, 1), pair.m(1, 1)},
        of_one_{pair.m(0, 2), pair.m(1, 2)},
        of_u_{pair.e[0], pair.e[1]},
        depth_{pair.m(2, 0), pair.m(2, 1), pair.m(2, 2), pair.e[2]},
        other_scale_(pair.other_scale),
        right_(other_map.width() - 1),
        bottom_(other_map.height() - 1),
        map_(other_map.row(0)),
        width_(other_map.width()) {}

  // nullopt: outside the other view, behind it, or hidden there by a surface more than kHiddenBy nearer.
  [[nodiscard, gnu::always_inline]] std::optional<Seen> Of(double x, double y, double u) const {
    const double qz = depth_[0] * x + depth_[1] * y + depth_[2] + depth_[3] * u;
    if (!(qz > 1e-6)) return std::nullopt;
    const double inverse = 1 / qz;
    const DoublePair at = (of_x_ * x + of_y_ * y + of_one_ + of_u_ * u) * inverse;
    if (!(at[0] >= 0 && at[1] >= 0 && at[0] <= right_ && at[1] <= bottom_)) return std::nullopt;
    const double u_in_other = other_scale_ * u * inverse;
    const IntPair nearest = WholePart(at + 0.5);
    const float there = map_[static_cast<std::ptrdiff_t>(nearest[1]) * width_ + nearest[0]];
    if (there > u_in_other + kHiddenBy) return std::nullopt;
    const DoublePair motion = (of_u_ - at * depth_[3]) * inverse;
    return Seen{.x = at[0], .y = at[1], .u_in_other = u_in_other, .dx = motion[0], .dy = motion[1]};
  }

 private:
  DoublePair of_x_, of_y_, of_one_, of_u_;  // of the position
  std::array<double, 4> depth_;             // of q_z: x, y, 1, u
  double other_scale_;
  double right_, bottom_;
  const float* map_;
  std::ptrdiff_t width_;
};

// Sight of one pixel.
[[nodiscard]] inline std::optional<Seen> SeenIn(const PairGeometry& pair, const InverseDepthMap& other_map, double x,
                                                double y, double u) {
  return Sight(pair, other_map).Of(x, y, u);
}

// Squared distance of two colours over Y, Cb, Cr.
[[nodiscard]] inline double SquaredDistance(ColourVector a, ColourVector b) {
  const ColourVector difference = a - b;
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += static_cast<double>(difference[i]) * difference[i];
  return sum;
}

// Robust standard deviation of the colour differences of a view against another, at least 1.5 grey levels.
[[nodiscard]] double MeasureNoise(const PictureColours& own, const InverseDepthMap& map, const OtherView& other);

// Depth (u of the other view) at the pixel where a point appears.
[[nodiscard]] inline double DepthAt(const InverseDepthMap& other_map, const Seen& seen) {
  return other_map(NearestPixel(seen.x), NearestPixel(seen.y));
}

// Whether all 3 x 3 pixels around (cx, cy) show what is at less than `bound`.
[[nodiscard]] inline bool AllFarther(const InverseDepthMap& map, int cx, int cy, double bound) {
  for (int y = std::max(0, cy - 1); y <= std::min(map.height() - 1, cy + 1); ++y)
    for (int x = std::max(0, cx - 1); x <= std::min(map.width() - 1, cx + 1); ++x)
      if (map(x, y) >= bound) return false;
  return true;
}

// Whether all 3 x 3 pixels around where a point appears show what is more than a pixel of u farther. One that does not
// is enough to believe in the point: contours of two views do not meet to the pixel.
[[nodiscard]] inline bool SeesThrough(const InverseDepthMap& other_map, const Seen& seen) {
  const int cx = NearestPixel(seen.x);
  const int cy = NearestPixel(seen.y);
  const double bound = seen.u_in_other - kHiddenBy;
  if (other_map(cx, cy) >= bound) return false;  // as most often
  return AllFarther(other_map, cx, cy, bound);
}

inline constexpr double kInMidAir = 0.03;  // of rho

// How well the colours of a view's pixels fit those of one other view. Refers to all that `other` refers to.
class ColourFit {
 public:
  explicit ColourFit(const OtherView& other)
      : sight_(*other.pair, *other.map),
        map_(other.map),
        colour_(other.colour),
        scale_(kChoiceKappa * kChoiceKappa * other.sigma * other.sigma) {}

  // rho of a pixel that appears there: 0 (its colour fits) to 1.
  [[nodiscard]] double MisfitAt(const Colour& own, const Seen& seen) const {
    const double t = SquaredDistance(colour_.Between(seen.x, seen.y), VectorOf(own)) / scale_;
    return t / (1 + t);
  }

  // rho of a pixel at u; nullopt where it is not seen.
  [[nodiscard]] std::optional<double> Misfit(const Colour& own, double x, double y, double u) const {
    const auto seen = sight_.Of(x, y, u);
    if (!seen) return std::nullopt;
    return MisfitAt(own, *seen);
  }

  // The same, but 2 rho + 0.03 (at most 1) where the other view sees through the point: between two surfaces that fit
  // alike it is not the one in mid-air.
  [[nodiscard]] std::optional<double> MisfitInFreeSpace(const Colour& own, double x, double y, double u) const {
    const auto seen = sight_.Of(x, y, u);
    if (!seen) return std::nullopt;
    const double rho = MisfitAt(own, *seen);
    return SeesThrough(*map_, *seen) ? std::min(1.0, 2 * rho + kInMidAir) : rho;
  }

 private:
  Sight sight_;
  const InverseDepthMap* map_;
  PictureColours colour_;
  double scale_;
};

// ColourFit of one pixel.
[[nodiscard]] inline double MisfitAt(const Colour& own, const OtherView& other, const Seen& seen) {
  return ColourFit(other).MisfitAt(own, seen);
}
[[nodiscard]] inline std::optional<double> Misfit(const Colour& own, const OtherView& other, double x, double y,
                                                  double u) {
  return ColourFit(other).Misfit(own, x, y, u);
}
[[nodiscard]] inline std::optional<double> MisfitInFreeSpace(const Colour& own, const OtherView& other, double x,
                                                             double y, double u) {
  return ColourFit(other).MisfitInFreeSpace(own, x, y, u);
}

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_OTHER_VIEW_H_
