#include "worker/refinement/other_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace depthfarm {
namespace {

constexpr double kHiddenBy = 1;         // pixels of u
constexpr double kInMidAir = 0.03;      // of rho
constexpr double kNoiseFloor = 1.5;     // grey levels
constexpr int kSampleStep = 3;          // pixels between those that the noise is measured on
constexpr double kMedianOfNorm = 1.54;  // median length of a vector of three normal variables of deviation 1

// Of a position that is not negative; std::lround is a call.
int Nearest(double position) {
  const double half_up = position + 0.5;
  return static_cast<int>(half_up);
}

}  // namespace

std::optional<Seen> SeenIn(const PairGeometry& pair, const InverseDepthMap& other_map, double x, double y, double u) {
  const Eigen::Matrix3d& m = pair.m;
  const double qz = m(2, 0) * x + m(2, 1) * y + m(2, 2) + pair.e[2] * u;
  if (!(qz > 1e-6)) return std::nullopt;
  Seen seen;
  seen.x = (m(0, 0) * x + m(0, 1) * y + m(0, 2) + pair.e[0] * u) / qz;
  seen.y = (m(1, 0) * x + m(1, 1) * y + m(1, 2) + pair.e[1] * u) / qz;
  if (!(seen.x >= 0 && seen.y >= 0 && seen.x <= other_map.width() - 1 && seen.y <= other_map.height() - 1))
    return std::nullopt;
  seen.u_in_other = pair.other_scale * u / qz;
  const float there = other_map(Nearest(seen.x), Nearest(seen.y));
  if (there > seen.u_in_other + kHiddenBy) return std::nullopt;
  seen.dx = (pair.e[0] - seen.x * pair.e[2]) / qz;
  seen.dy = (pair.e[1] - seen.y * pair.e[2]) / qz;
  return seen;
}

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
  return other_map(Nearest(seen.x), Nearest(seen.y));
}

bool SeesThrough(const InverseDepthMap& other_map, const Seen& seen) {
  const int cx = Nearest(seen.x);
  const int cy = Nearest(seen.y);
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
