#include "common/quality/stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace depthfarm {
namespace {

constexpr int kReachPx = 3;
// One level, and what the 16-bit codes of depth files round (see consistency.cc).
constexpr double kChangedLevels = 1.02;

using Difference = std::array<std::int32_t, 3>;

Difference DifferenceOf(const Ycbcr& a, const Ycbcr& b) { return {a.y - b.y, a.cb - b.cb, a.cr - b.cr}; }

double Ratio(double part, std::int64_t whole) {
  return whole > 0 ? part / static_cast<double>(whole) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void StabilityFigures::Add(const StabilityFigures& other) {
  still += other.still;
  changed += other.changed;
  level_difference_sum += other.level_difference_sum;
}

double StabilityFigures::ChangedPercent() const { return 100 * Ratio(static_cast<double>(changed), still); }

double StabilityFigures::MeanLevelDifference() const { return Ratio(level_difference_sum, still); }

PixelMask StillPixels(const YcbcrImage& before, const YcbcrImage& now, double threshold) {
  const int width = now.width();
  const int height = now.height();
  // Sums over all pixels above and to the left: the sum of any rectangle is four of them.
  Grid<Difference> sums(width + 1, height + 1, Difference{});
  for (int y = 0; y < height; ++y) {
    Difference row = {};
    for (int x = 0; x < width; ++x) {
      const Difference d = DifferenceOf(now(x, y), before(x, y));
      for (std::size_t c = 0; c < 3; ++c) {
        row[c] += d[c];
        sums(x + 1, y + 1)[c] = sums(x + 1, y)[c] + row[c];
      }
    }
  }
  PixelMask still(width, height);
  for (int y = 0; y < height; ++y) {
    const int top = std::max(0, y - kReachPx);
    const int bottom = std::min(height, y + kReachPx + 1);
    for (int x = 0; x < width; ++x) {
      const int left = std::max(0, x - kReachPx);
      const int right = std::min(width, x + kReachPx + 1);
      std::int32_t change = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        change += std::abs(sums(right, bottom)[c] - sums(left, bottom)[c] - sums(right, top)[c] + sums(left, top)[c]);
      }
      still(x, y) = change <= threshold * (right - left) * (bottom - top) ? 1 : 0;
    }
  }
  return still;
}

StabilityFigures MeasureStability(const DepthMap& before, const ViewDepth& now, const PixelMask& still,
                                  const DepthLevels& levels) {
  const LevelsInView in_view(now.camera, levels);
  StabilityFigures figures;
  for (int y = 0; y < still.height(); ++y) {
    for (int x = 0; x < still.width(); ++x) {
      const double old_z = static_cast<double>(before(x, y));
      const double z = static_cast<double>((*now.depth)(x, y));
      if (still(x, y) == 0 || !(old_z > 0) || !(z > 0)) continue;
      const double old_in_ref = in_view.DepthInRef(x, y, old_z);
      const double in_ref = in_view.DepthInRef(x, y, z);
      if (!(old_in_ref > 0) || !(in_ref > 0)) continue;
      const double difference = std::abs(LevelIndex(levels, in_ref) - LevelIndex(levels, old_in_ref));
      ++figures.still;
      figures.changed += difference > kChangedLevels ? 1 : 0;
      figures.level_difference_sum += difference;
    }
  }
  return figures;
}

}  // namespace depthfarm
