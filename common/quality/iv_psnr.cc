#include "common/quality/iv_psnr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace depthfarm {
namespace {

constexpr int kReachPx = 2;
constexpr int kMostOffset = 3;  // 1 % of 255, rounded
constexpr std::array<int, 3> kWeights = {4, 1, 1};

using Sample = std::array<int, 3>;
using Samples = Grid<Sample>;

Samples InVideoRange(const YcbcrImage& picture) {
  std::array<int, 256> luma = {};
  std::array<int, 256> chroma = {};
  for (int v = 0; v < 256; ++v) {
    luma[static_cast<std::size_t>(v)] = static_cast<int>(std::lround(16 + v * 219.0 / 255.0));
    chroma[static_cast<std::size_t>(v)] = static_cast<int>(std::lround(128 + (v - 128) * 224.0 / 255.0));
  }
  Samples result(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const Ycbcr& pixel = picture.values()[i];
    result.values()[i] = {luma[pixel.y], chroma[pixel.cb], chroma[pixel.cr]};
  }
  return result;
}

// Mean of b - a per component, rounded, bounded.
Sample MeanOffset(const Samples& a, const Samples& b) {
  std::array<std::int64_t, 3> sum = {};
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += b.values()[i][c] - a.values()[i][c];
  }
  Sample offset = {};
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = static_cast<double>(sum[c]) / static_cast<double>(a.size());
    offset[c] = std::clamp(static_cast<int>(std::lround(mean)), -kMostOffset, kMostOffset);
  }
  return offset;
}

Sample SquaredDifference(const Sample& a, const Sample& b) {
  Sample result = {};
  for (std::size_t c = 0; c < 3; ++c) result[c] = (a[c] - b[c]) * (a[c] - b[c]);
  return result;
}

int Weighted(const Sample& value) { return kWeights[0] * value[0] + kWeights[1] * value[1] + kWeights[2] * value[2]; }

// Squared differences of `pixel` and the most similar one of those around (x, y) in `other`.
Sample LeastDifference(const Sample& pixel, const Samples& other, int x, int y) {
  Sample best = {};
  int best_cost = std::numeric_limits<int>::max();
  for (int v = std::max(0, y - kReachPx); v <= std::min(other.height() - 1, y + kReachPx); ++v) {
    for (int u = std::max(0, x - kReachPx); u <= std::min(other.width() - 1, x + kReachPx); ++u) {
      const Sample difference = SquaredDifference(pixel, other(u, v));
      const int cost = Weighted(difference);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = difference;
    }
  }
  return best;
}

double OneWay(const Samples& from, const Samples& to, const Sample& offset) {
  std::array<std::int64_t, 3> error = {};
  for (int y = 0; y < from.height(); ++y) {
    for (int x = 0; x < from.width(); ++x) {
      Sample pixel = from(x, y);
      for (std::size_t c = 0; c < 3; ++c) pixel[c] += offset[c];
      const Sample difference = LeastDifference(pixel, to, x, y);
      for (std::size_t c = 0; c < 3; ++c) error[c] += difference[c];
    }
  }
  double weighted = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double sum = static_cast<double>(std::max<std::int64_t>(error[c], 1));
    weighted += kWeights[c] * 10 * std::log10(255.0 * 255.0 * static_cast<double>(from.size()) / sum);
  }
  return weighted / (kWeights[0] + kWeights[1] + kWeights[2]);
}

}  // namespace

double IvPsnr(const YcbcrImage& a, const YcbcrImage& b) {
  if (a.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const Samples in_a = InVideoRange(a);
  const Samples in_b = InVideoRange(b);
  const Sample offset = MeanOffset(in_a, in_b);
  const Sample back = {-offset[0], -offset[1], -offset[2]};
  return std::min(OneWay(in_a, in_b, offset), OneWay(in_b, in_a, back));
}

}  // namespace depthfarm
