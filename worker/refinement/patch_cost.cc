#include "worker/refinement/patch_cost.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "worker/refinement/better_half.h"

namespace depthfarm {
namespace {

constexpr double kColourFalloff = 40;  // grey levels, summed over the components
constexpr double kNotSeen = -1;

}  // namespace

double ColourWeight(const Colour& a, const Colour& b) {
  double d = 0;
  for (int i = 0; i < 4; ++i) d += std::abs(a[i] - b[i]);
  const double base = 1 / (1 + d / kColourFalloff);
  return base * base * base * base;
}

PatchCost::PatchCost(const ColourGrid& own, std::span<const OtherView> others)
    : own_(own),
      others_(others.first(std::min<std::size_t>(others.size(), kMostCompared))),
      slot_(own.width(), own.height(), 0),
      misfits_(1) {}

const PatchCost::Misfits& PatchCost::MisfitsAt(int x, int y, const SlantedPlane& plane) {
  std::uint32_t& slot = slot_(x, y);
  if (slot == 0) {
    slot = static_cast<std::uint32_t>(misfits_.size());
    misfits_.emplace_back();
  }
  Misfits& misfits = misfits_[slot];
  if (misfits.turn == turn_) return misfits;
  misfits.turn = turn_;
  const double u = plane.At(x, y);
  for (std::size_t i = 0; i < others_.size(); ++i)
    misfits.rho[i] = MisfitInFreeSpace(own_(x, y), others_[i], x, y, u).value_or(kNotSeen);
  return misfits;
}

double PatchCost::At(int x0, int y0, PlaneIndex index, const SlantedPlane& plane) {
  if (turn_ == 0 || index != current_) {
    ++turn_;
    current_ = index;
  }
  std::array<double, kMostCompared> sums{};
  std::array<double, kMostCompared> weights{};
  for (int y = std::max(0, y0 - 1); y <= std::min(own_.height() - 1, y0 + 1); ++y) {
    for (int x = std::max(0, x0 - 1); x <= std::min(own_.width() - 1, x0 + 1); ++x) {
      const double weight = ColourWeight(own_(x, y), own_(x0, y0));
      const Misfits& misfits = MisfitsAt(x, y, plane);
      for (std::size_t i = 0; i < others_.size(); ++i) {
        if (misfits.rho[i] == kNotSeen) continue;
        sums[i] += weight * misfits.rho[i];
        weights[i] += weight;
      }
    }
  }
  BetterHalf means;
  for (std::size_t i = 0; i < others_.size(); ++i)
    if (weights[i] > 0) means.Add(sums[i] / weights[i]);
  return means.Mean();
}

}  // namespace depthfarm
