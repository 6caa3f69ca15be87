#include "worker/refinement/region_fit.h"

#include <array>

#include "common/geometry/symmetric_solve.h"

namespace depthfarm {

void RegionFit::AddTo(Judgement& judgement, PixelList& list) const {
  const std::size_t first = judgement.misfits.size();
  judgement.misfits.resize(first + list.count * others_.size(), kUnseen);
  ListOf<double> misfits;
  ListOf<double> sums;
  ListOf<int> views;
  sums.fill(0);
  views.fill(0);
  for (std::size_t view = 0; view < others_.size(); ++view) {
    Misfits(others_[view], list, misfits);
    for (std::size_t i = 0; i < list.count; ++i) {
      if (misfits[i] == kNotSeen) continue;
      judgement.misfits[first + i * others_.size() + view] = static_cast<float>(misfits[i]);
      sums[i] += misfits[i];
      ++views[i];
    }
  }
  for (std::size_t i = 0; i < list.count; ++i) {
    if (views[i] == 0) continue;
    judgement.cost += sums[i] / views[i];
    ++judgement.seen;
  }
}

double RegionFit::Excess(const Judgement& a, const Judgement& b, std::size_t i) const {
  double sum_a = 0;
  double sum_b = 0;
  double sum_both = 0;
  int views_a = 0;
  int views_b = 0;
  int views_both = 0;
  for (std::size_t at = i * others_.size(); at < (i + 1) * others_.size(); ++at) {
    const bool in_a = a.misfits[at] != kUnseen;
    const bool in_b = b.misfits[at] != kUnseen;
    if (in_a) {
      sum_a += double{a.misfits[at]};
      ++views_a;
    }
    if (in_b) {
      sum_b += double{b.misfits[at]};
      ++views_b;
    }
    if (in_a && in_b) {
      sum_both += double{a.misfits[at]} - double{b.misfits[at]};
      ++views_both;
    }
  }
  if (views_both > 0) return sum_both / views_both;
  return views_a > 0 && views_b > 0 ? sum_a / views_a - sum_b / views_b : 0;
}

double RegionFit::Excess(const Judgement& a, const Judgement& b) const {
  double sum = 0;
  if (others_.empty()) return sum;
  for (std::size_t i = 0; i < a.misfits.size() / others_.size(); ++i) sum += Excess(a, b, i);
  return sum;
}

std::optional<SlantedPlane> FitPlane(std::span<const DepthPoint> points, double center_x, double center_y) {
  constexpr std::size_t kFewest = 4;
  constexpr int kRounds = 8;
  constexpr double kUnit = 100;   // pixels
  constexpr double kRidge = 0.1;  // of the weights, per unit
  if (points.size() < kFewest) return std::nullopt;
  std::array<double, 3> fit{};  // u = fit . ((x - center_x) / unit, (y - center_y) / unit, 1)
  for (int round = 0; round < kRounds; ++round) {
    const double scale = round < 3 ? 1.0 : 0.4;  // pixels of u
    std::array<double, 6> h{};
    std::array<double, 3> r{};
    double weights = 0;
    for (const DepthPoint& point : points) {
      const double x = (point.x - center_x) / kUnit;
      const double y = (point.y - center_y) / kUnit;
      const double e = (point.u - (fit[0] * x + fit[1] * y + fit[2])) / scale;
      const double w = round == 0 ? 1 : 1 / ((1 + e * e) * (1 + e * e));
      h[0] += w * x * x;
      h[1] += w * x * y;
      h[2] += w * x;
      h[3] += w * y * y;
      h[4] += w * y;
      h[5] += w;
      r[0] += w * x * point.u;
      r[1] += w * y * point.u;
      r[2] += w * point.u;
      weights += w;
    }
    h[0] += kRidge * weights;
    h[3] += kRidge * weights;
    if (!SolveSymmetric(h, r, fit)) return std::nullopt;
  }
  const double a = fit[0] / kUnit;
  const double b = fit[1] / kUnit;
  return SlantedPlane{static_cast<float>(a), static_cast<float>(b),
                      static_cast<float>(fit[2] - a * center_x - b * center_y)};
}

}  // namespace depthfarm
