#include "worker/refinement/patch_sums.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "worker/refinement/colour_weight.h"

// This file is compiled once for each kind of vector.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "worker/refinement/patch_sums.cc"
#include <hwy/foreach_target.h>
// The order is Highway's.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace depthfarm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kRowPixels = 4;  // three and one more

// Differences of the pixels of a patch, and one more of each row, to its centre: summed over the components.
#if HWY_TARGET == HWY_SCALAR
void PatchDifferences(const YcbcrImage& own, const PatchPlace& place, std::uint64_t* differences) {
  const Ycbcr center = own(place.x, place.y);
  for (int row = -1; row <= 1; ++row) {
    const Ycbcr* pixels = own.row(place.y + row) + place.x - 1;
    for (std::size_t i = 0; i < kRowPixels; ++i)
      *differences++ = static_cast<std::uint64_t>(ColourDifference(pixels[i], center));
  }
}
#else
void PatchDifferences(const YcbcrImage& own, const PatchPlace& place, std::uint64_t* differences) {
  const hn::CappedTag<std::uint64_t, kRowPixels> d;
  const hn::Rebind<std::uint32_t, decltype(d)> of_pixels;
  const hn::Repartition<std::uint8_t, decltype(d)> bytes;
  std::uint32_t central = 0;
  static_assert(sizeof(central) == sizeof(Ycbcr));
  std::memcpy(&central, own.row(place.y) + place.x, sizeof(central));
  const auto center = hn::BitCast(bytes, hn::Set(d, central));
  for (int row = -1; row <= 1; ++row) {
    const auto* at = reinterpret_cast<const std::uint32_t*>(own.row(place.y + row) + place.x - 1);
    for (std::size_t i = 0; i < kRowPixels; i += hn::Lanes(d)) {
      const auto pixels = hn::BitCast(bytes, hn::PromoteTo(d, hn::LoadU(of_pixels, at + i)));
      const auto apart = hn::Or(hn::SaturatedSub(pixels, center), hn::SaturatedSub(center, pixels));
      hn::StoreU(hn::SumsOf8(apart), d, differences + i);
    }
    differences += kRowPixels;
  }
}
#endif

void SumPatch(const PixelMisfits* top_left, std::size_t stride, const double* weights, PatchSums& result) {
  const hn::CappedTag<double, kMostCompared> d;
  for (std::size_t view = 0; view < kMostCompared; view += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    auto weight = hn::Zero(d);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        const auto rho = hn::LoadU(d, top_left[row * stride + column].data() + view);
        const auto seen = hn::Ge(rho, hn::Zero(d));
        const auto w = hn::Set(d, weights[row * kRowPixels + column]);
        sum = hn::Add(sum, hn::IfThenElseZero(seen, hn::Mul(w, rho)));
        weight = hn::Add(weight, hn::IfThenElseZero(seen, w));
      }
    }
    hn::StoreU(sum, d, result.sums.data() + view);
    hn::StoreU(weight, d, result.weights.data() + view);
  }
}

void SumEach(const YcbcrImage& own, std::span<const PatchPlace> places, const PixelMisfits* misfits, std::size_t stride,
             PatchSums* result) {
  constexpr std::size_t kRead = 3 * kRowPixels;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const PatchPlace& place = places[i];
    if (!HasWholePatch(own, place)) continue;
    std::uint64_t differences[kRead];
    PatchDifferences(own, place, differences);
    double weights[kRead];
    for (std::size_t j = 0; j < kRead; ++j) weights[j] = colour_weight_internal::kWeights[differences[j]];
    SumPatch(misfits + place.cell - stride - 1, stride, weights, result[i]);
  }
}

}  // namespace depthfarm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace depthfarm {

HWY_EXPORT(SumEach);

void SumPatches(const YcbcrImage& own, std::span<const PatchPlace> places, std::span<const PixelMisfits> misfits,
                std::size_t stride, std::span<PatchSums> result) {
  HWY_DYNAMIC_DISPATCH(SumEach)(own, places, misfits.data(), stride, result.data());
}

}  // namespace depthfarm
#endif
