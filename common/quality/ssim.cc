#include "common/quality/ssim.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace depthfarm {
namespace {

constexpr int kWindow = 11;
constexpr double kSigma = 1.5;

// Windowed means of a, b, a a, b b, a b.
using Moments = std::array<float, 5>;

std::array<float, kWindow> GaussianWindow() {
  std::array<double, kWindow> weights = {};
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) {
    const double d = i - kWindow / 2;
    weights[static_cast<std::size_t>(i)] = std::exp(-d * d / (2 * kSigma * kSigma));
    sum += weights[static_cast<std::size_t>(i)];
  }
  std::array<float, kWindow> result = {};
  for (std::size_t i = 0; i < kWindow; ++i) result[i] = static_cast<float>(weights[i] / sum);
  return result;
}

// One row filtered along x; luma taken relative to mid-grey so that float keeps the variances exact enough.
void FilterRow(const YcbcrImage& a, const YcbcrImage& b, int y, const std::array<float, kWindow>& window,
               std::vector<Moments>& result) {
  std::vector<Moments> products(static_cast<std::size_t>(a.width()));
  for (int x = 0; x < a.width(); ++x) {
    const float va = static_cast<float>(a(x, y).y) - 128.0F;
    const float vb = static_cast<float>(b(x, y).y) - 128.0F;
    products[static_cast<std::size_t>(x)] = {va, vb, va * va, vb * vb, va * vb};
  }
  for (std::size_t x = 0; x < result.size(); ++x) {
    Moments sum = {};
    for (std::size_t k = 0; k < kWindow; ++k) {
      for (std::size_t m = 0; m < sum.size(); ++m) sum[m] += window[k] * products[x + k][m];
    }
    result[x] = sum;
  }
}

double Similarity(const Moments& moments) {
  constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
  constexpr double kC2 = (0.03 * 255) * (0.03 * 255);
  const double ma = moments[0];
  const double mb = moments[1];
  const double var_a = moments[2] - ma * ma;
  const double var_b = moments[3] - mb * mb;
  const double cov = moments[4] - ma * mb;
  const double pa = ma + 128.0;
  const double pb = mb + 128.0;
  return (2 * pa * pb + kC1) * (2 * cov + kC2) / ((pa * pa + pb * pb + kC1) * (var_a + var_b + kC2));
}

}  // namespace

double Ssim(const YcbcrImage& a, const YcbcrImage& b) {
  const int columns = a.width() - kWindow + 1;
  const int rows = a.height() - kWindow + 1;
  if (columns < 1 || rows < 1) return std::numeric_limits<double>::quiet_NaN();
  const std::array<float, kWindow> window = GaussianWindow();
  // The last kWindow filtered rows, row y in slot y % kWindow.
  std::vector<std::vector<Moments>> ring(kWindow, std::vector<Moments>(static_cast<std::size_t>(columns)));
  double sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    FilterRow(a, b, y, window, ring[static_cast<std::size_t>(y % kWindow)]);
    if (y + 1 < kWindow) continue;
    for (std::size_t x = 0; x < static_cast<std::size_t>(columns); ++x) {
      Moments moments = {};
      for (int k = 0; k < kWindow; ++k) {
        const Moments& row = ring[static_cast<std::size_t>((y + 1 + k) % kWindow)][x];
        for (std::size_t m = 0; m < moments.size(); ++m) moments[m] += window[static_cast<std::size_t>(k)] * row[m];
      }
      sum += Similarity(moments);
    }
  }
  return sum / (static_cast<double>(columns) * rows);
}

}  // namespace depthfarm
