#include "worker/refinement/other_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace depthfarm {
namespace {

constexpr double kInMidAir = 0.03;      // of rho
constexpr double kNoiseFloor = 1.5;     // grey levels
constexpr int kSampleStep = 5;          // pixels between those that the noise is measured on
constexpr double kMedianOfNorm = 1.54;  // median length of a vector of three normal variables of deviation 1

}  // namespace

double SquaredDistance(const Colour& a, const Colour& b) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += static_cast<double>(a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

double MeasureNoise(const ColourGrid& own, const InverseDepthMap& map, const OtherView& other) {
  std::vector<double> squares;
  for (int y = 1; y < own.height(); y += kSampleStep) {
    for (int x = 1; x < own.width(); x += kSampleStep) {
      const auto seen = SeenIn(*other.pair, *other.map, x, y, map(x, y));
      if (seen) squares.push_back(SquaredDistance(SampleAt(*other.colour, seen->x, seen->y), own(x, y)));
    }
  }
  if (squares.empty()) return kNoiseFloor;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::max(kNoiseFloor, std::sqrt(*middle) / kMedianOfNorm);
}

double DepthAt(const InverseDepthMap& other_map, const Seen& seen) {
  return other_map(NearestPixel(seen.x), NearestPixel(seen.y));
}

bool SeesThrough(const InverseDepthMap& other_map, const Seen& seen) {
  const int cx = NearestPixel(seen.x);
  const int cy = NearestPixel(seen.y);
  for (int y = std::max(0, cy - 1); y <= std::min(other_map.height() - 1, cy + 1); ++y)
    for (int x = std::max(0, cx - 1); x <= std::min(other_map.width() - 1, cx + 1); ++x)
      if (other_map(x, y) >= seen.u_in_other - kHiddenBy) return false;
  return true;
}

double MisfitAt(const Colour& own, const OtherView& other, const Seen& seen) {
  const double t = SquaredDistance(SampleAt(*other.colour, seen.x, seen.y), own) /
                   (kChoiceKappa * kChoiceKappa * other.sigma * other.sigma);
  return t / (1 + t);
}

std::optional<double> Misfit(const Colour& own, const OtherView& other, double x, double y, double u) {
  const auto seen = SeenIn(*other.pair, *other.map, x, y, u);
  if (!seen) return std::nullopt;
  return MisfitAt(own, other, *seen);
}

std::optional<double> MisfitInFreeSpace(const Colour& own, const OtherView& other, double x, double y, double u) {
  const auto seen = SeenIn(*other.pair, *other.map, x, y, u);
  if (!seen) return std::nullopt;
  const double rho = MisfitAt(own, other, *seen);
  return SeesThrough(*other.map, *seen) ? std::min(1.0, 2 * rho + kInMidAir) : rho;
}

}  // namespace depthfarm
