#include "worker/refinement/other_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace depthfarm {
namespace {

constexpr double kNoiseFloor = 1.5;     // grey levels
constexpr int kSampleStep = 5;          // pixels between those that the noise is measured on
constexpr double kMedianOfNorm = 1.54;  // median length of a vector of three normal variables of deviation 1

}  // namespace

double MeasureNoise(const PictureColours& own, const InverseDepthMap& map, const OtherView& other) {
  const Sight sight(*other.pair, *other.map);
  std::vector<double> squares;
  for (int y = 1; y < own.height(); y += kSampleStep) {
    for (int x = 1; x < own.width(); x += kSampleStep) {
      const auto seen = sight.Of(x, y, map(x, y));
      if (seen) squares.push_back(SquaredDistance(other.colour.Between(seen->x, seen->y), VectorOf(own(x, y))));
    }
  }
  if (squares.empty()) return kNoiseFloor;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::max(kNoiseFloor, std::sqrt(*middle) / kMedianOfNorm);
}

}  // namespace depthfarm
