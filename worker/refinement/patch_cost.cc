#include "worker/refinement/patch_cost.h"

#include <algorithm>
#include <cstddef>

#include "worker/refinement/better_half.h"
#include "worker/refinement/colour_weight.h"

namespace depthfarm {
namespace {

constexpr double kNotSeen = -1;
// Of the misfits that are kept. Three rows are read at a time; most segments are narrower, and the whole fits into the
// nearest cache.
constexpr std::size_t kRows = 4;
constexpr std::size_t kColumns = 128;

}  // namespace

PatchCost::PatchCost(const YcbcrImage& own, std::span<const OtherView> others) : own_(own), recent_(kRows * kColumns) {
  for (const OtherView& other : others.first(std::min<std::size_t>(others.size(), kMostCompared)))
    others_.emplace_back(other);
}

const PatchCost::Misfits& PatchCost::MisfitsAt(int x, int y, const SlantedPlane& plane) {
  Misfits& misfits = recent_[static_cast<std::size_t>(y) % kRows * kColumns + static_cast<std::size_t>(x) % kColumns];
  if (misfits.turn == turn_ && misfits.x == x && misfits.y == y) return misfits;
  misfits.turn = turn_;
  misfits.x = x;
  misfits.y = y;
  const double u = plane.At(x, y);
  const Colour own = ColourOf(own_(x, y));
  for (std::size_t i = 0; i < others_.size(); ++i)
    misfits.rho[i] = others_[i].MisfitInFreeSpace(own, x, y, u).value_or(kNotSeen);
  return misfits;
}

double PatchCost::At(int x0, int y0, PlaneIndex index, const SlantedPlane& plane) {
  if (turn_ == 0 || index != current_) {
    ++turn_;
    current_ = index;
  }
  std::array<double, kMostCompared> sums{};
  std::array<double, kMostCompared> weights{};
  const Ycbcr center = own_(x0, y0);
  for (int y = std::max(0, y0 - 1); y <= std::min(own_.height() - 1, y0 + 1); ++y) {
    for (int x = std::max(0, x0 - 1); x <= std::min(own_.width() - 1, x0 + 1); ++x) {
      const double weight = ColourWeight(own_(x, y), center);
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
