#include "worker/refinement/patch_cost.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "worker/refinement/better_half.h"
#include "worker/refinement/colour_weight.h"

namespace depthfarm {
namespace {

constexpr double kNoMean = std::numeric_limits<double>::infinity();

// Over the better half of the views.
double MeanOfBetterHalf(const PatchSums& of) {
  static_assert(kMostCompared == 4);
  const auto mean = [&](std::size_t view) { return of.weights[view] > 0 ? of.sums[view] / of.weights[view] : kNoMean; };
  const auto [least_of_two, other_of_two] = std::minmax({mean(0), mean(1)});
  const auto [least_of_next, other_of_next] = std::minmax({mean(2), mean(3)});
  const double first = std::min(least_of_two, least_of_next);
  const auto [second, third] =
      std::minmax({std::max(least_of_two, least_of_next), std::min(other_of_two, other_of_next)});
  if (first == kNoMean) return BetterHalf::kUnseen;
  return third == kNoMean ? first : (first + second) / 2;
}

}  // namespace

PatchCost::PatchCost(const YcbcrImage& own, std::span<const OtherView> others)
    : own_(own),
      others_(others.begin(),
              others.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(others.size(), kMostCompared))),
      misfits_(kStride * (kRows + 2)) {}

void PatchCost::StoreMisfits() {
  std::array<ListOf<double>, kMostCompared> of_views;
  for (std::size_t view = 0; view < kMostCompared; ++view) {
    if (view < others_.size()) {
      MisfitsInFreeSpace(others_[view], list_, of_views[view]);
    } else {
      of_views[view].fill(kNotSeen);
    }
  }
  for (std::size_t i = 0; i < list_.count; ++i)
    misfits_[cells_[i]] = {of_views[0][i], of_views[1][i], of_views[2][i], of_views[3][i]};
  list_.count = 0;
}

void PatchCost::FindMisfits(const SlantedPlane& plane, int left, int top) {
  // Bit c of row r: that of (left + c - 1, top + r - 1) is needed.
  std::array<std::uint64_t, kRows + 2> needed{};
  for (const PatchPlace& place : places_) {
    const std::uint64_t columns = std::uint64_t{7} << (place.x - left);
    const auto row = static_cast<std::size_t>(place.y - top);
    for (std::size_t i = row; i < row + 3; ++i) needed[i] |= columns;
  }
  std::uint64_t inside = ~std::uint64_t{0};
  if (left == 0) inside <<= 1;
  if (const int beyond = left + kColumns + 1 - own_.width(); beyond > 0) inside &= ~std::uint64_t{0} >> beyond;
  for (std::size_t row = 0; row < needed.size(); ++row) {
    const int y = top + static_cast<int>(row) - 1;
    if (y < 0 || y >= own_.height()) continue;
    for (std::uint64_t bits = needed[row] & inside; bits != 0; bits &= bits - 1) {
      const int column = std::countr_zero(bits);
      const int x = left + column - 1;
      cells_[list_.count] = row * kStride + static_cast<std::size_t>(column);
      list_.Add(own_, x, y, plane.At(x, y));
      if (list_.count == kListPixels) StoreMisfits();
    }
  }
  StoreMisfits();
}

PatchSums PatchCost::SumsAtBorder(const PatchPlace& place) const {
  PatchSums result;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (!own_.Contains(place.x + dx, place.y + dy)) continue;
      const double weight = ColourWeight(own_(place.x + dx, place.y + dy), own_(place.x, place.y));
      const PixelMisfits& misfits =
          misfits_[static_cast<std::size_t>(std::ptrdiff_t{place.cell} + dy * std::ptrdiff_t{kStride} + dx)];
      for (std::size_t view = 0; view < kMostCompared; ++view) {
        if (misfits[view] == kNotSeen) continue;
        result.sums[view] += weight * misfits[view];
        result.weights[view] += weight;
      }
    }
  }
  return result;
}

void PatchCost::SumWindow(const SlantedPlane& plane, int left, int top, std::span<double> costs) {
  FindMisfits(plane, left, top);
  sums_.resize(places_.size());
  SumPatches(own_, places_, misfits_, kStride, sums_);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const bool whole = HasWholePatch(own_, places_[i]);
    costs[numbers_[i]] = MeanOfBetterHalf(whole ? sums_[i] : SumsAtBorder(places_[i]));
  }
  places_.clear();
  numbers_.clear();
}

void PatchCost::Costs(const SlantedPlane& plane, std::span<const PixelPosition> pixels, std::span<double> costs) {
  if (pixels.empty()) return;
  const auto [leftmost, rightmost] =
      std::minmax_element(pixels.begin(), pixels.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  for (int left = leftmost->x; left <= rightmost->x; left += kColumns) {
    int top = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto [x, y] = pixels[i];
      if (x < left || x >= left + kColumns) continue;
      if (!places_.empty() && (y < top || y >= top + kRows)) SumWindow(plane, left, top, costs);
      if (places_.empty()) top = y;
      const auto cell = static_cast<std::size_t>(y - top + 1) * kStride + static_cast<std::size_t>(x - left + 1);
      places_.push_back({.x = x, .y = y, .cell = static_cast<std::uint32_t>(cell)});
      numbers_.push_back(i);
    }
    if (!places_.empty()) SumWindow(plane, left, top, costs);
  }
}

}  // namespace depthfarm
