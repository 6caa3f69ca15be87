#include "worker/refinement/other_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "worker/refinement/sight_kernels.h"

namespace depthfarm {
namespace {

constexpr double kNoiseFloor = 1.5;     // grey levels
constexpr int kSampleStep = 5;          // pixels between those that the noise is measured on
constexpr double kMedianOfNorm = 1.54;  // median length of a vector of three normal variables of deviation 1

}  // namespace

double MeasureNoise(const PictureColours& own, const InverseDepthMap& map, const OtherView& other) {
  std::vector<double> squares;
  squares.reserve(map.size() / (kSampleStep * kSampleStep));
  PixelList list;
  ListOf<double> distances;
  const auto measure = [&] {
    SquaredDistances(other, list, distances);
    for (const double square : std::span(distances).first(list.count))
      if (square != kNotSeen) squares.push_back(square);
    list.count = 0;
  };
  own.With([&](const auto& picture) {
    for (int y = 1; y < own.height(); y += kSampleStep) {
      for (int x = 1; x < own.width(); x += kSampleStep) {
        list.Add(picture, x, y, map(x, y));
        if (list.count == kListPixels) measure();
      }
    }
  });
  measure();
  if (squares.empty()) return kNoiseFloor;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::max(kNoiseFloor, std::sqrt(*middle) / kMedianOfNorm);
}

}  // namespace depthfarm
