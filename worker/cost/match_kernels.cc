#include "worker/cost/match_kernels.h"

#include <algorithm>
#include <cstddef>

// This file is compiled once for each kind of vector.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "worker/cost/match_kernels.cc"
#include <hwy/foreach_target.h>
// The order is Highway's.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace depthfarm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMostLanes = 8;

// Of kMostLanes or fewer planes at a time: x and y of as many lanes.
void ProjectLanes(const EpipolarLine& line, const double* factors, std::int32_t* xs, std::int32_t* ys) {
  const hn::CappedTag<double, kMostLanes> d;
  const hn::Rebind<std::int32_t, decltype(d)> di;
  const auto half = hn::Set(d, 0.5);
  const auto low = hn::Set(d, -0.5);
  const auto right = hn::Set(d, line.width - 0.5);
  const auto bottom = hn::Set(d, line.height - 0.5);
  const auto none = hn::Set(d, -1.0);
  for (std::size_t i = 0; i < kMostLanes; i += hn::Lanes(d)) {
    const auto inverse = hn::Mul(hn::Set(d, line.slope), hn::LoadU(d, factors + i));
    const auto q = [&](std::size_t row) {
      return hn::Add(hn::Set(d, line.at_infinity[row]), hn::Mul(hn::Set(d, line.per_inverse_depth[row]), inverse));
    };
    const auto qz = q(2);
    const auto x = hn::Div(q(0), qz);
    const auto y = hn::Div(q(1), qz);
    const auto inside_x = hn::And(hn::Ge(x, low), hn::Lt(x, right));
    const auto inside_y = hn::And(hn::Ge(y, low), hn::Lt(y, bottom));
    const auto inside = hn::And(hn::Gt(qz, hn::Zero(d)), hn::And(inside_x, inside_y));
    // What is converted is at least 0, so cutting off the fraction rounds down.
    hn::StoreU(hn::DemoteTo(di, hn::IfThenElse(inside, hn::Add(x, half), none)), di, xs + i);
    hn::StoreU(hn::DemoteTo(di, hn::IfThenElse(inside, hn::Add(y, half), none)), di, ys + i);
  }
}

void ProjectPlanes(const EpipolarLine& line, const double* factors, std::size_t count, PixelPosition* targets) {
  for (std::size_t begin = 0; begin < count; begin += kMostLanes) {
    const std::size_t lanes = std::min(kMostLanes, count - begin);
    double last[kMostLanes] = {};
    const double* from = factors + begin;
    if (lanes < kMostLanes) {
      std::copy(from, from + lanes, last);
      from = last;
    }
    std::int32_t xs[kMostLanes];
    std::int32_t ys[kMostLanes];
    ProjectLanes(line, from, xs, ys);
    for (std::size_t i = 0; i < lanes; ++i) targets[begin + i] = {xs[i], ys[i]};
  }
}

#if HWY_TARGET == HWY_SCALAR
void SumWindows(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center, const PixelPosition* targets,
                std::size_t count, std::int32_t offset_steps, std::uint16_t* rewards) {
  for (std::size_t i = 0; i < count; ++i) {
    const PixelPosition target = targets[i];
    if (!HasWholeWindow(neighbour, target)) continue;
    std::int32_t sum = 0;
    for (int row = -1; row <= 1; ++row) {
      const Ycbcr* own = view.row(center.y + row) + center.x;
      const Ycbcr* other = neighbour.row(target.y + row) + target.x;
      for (int column = -1; column <= 1; ++column) sum += L1Distance(own[column], other[column]);
    }
    rewards[i] = static_cast<std::uint16_t>(std::max(0, offset_steps - sum));
  }
}
#else
// Three pixels of three rows each: their colours alone.
void SumWindows(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center, const PixelPosition* targets,
                std::size_t count, std::int32_t offset_steps, std::uint16_t* rewards) {
  const hn::FixedTag<std::uint8_t, 16> d;
  const hn::Repartition<std::uint64_t, decltype(d)> d64;
  alignas(16) static constexpr std::uint8_t kColours[16] = {255, 255, 255, 0, 255, 255, 255, 0, 255, 255, 255, 0};
  const auto colours = hn::Load(d, kColours);
  const auto three_pixels = [&](const YcbcrImage& picture, PixelPosition pixel, int row) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(picture.row(pixel.y + row) + pixel.x - 1);
    return hn::And(hn::LoadU(d, bytes), colours);
  };
  const auto above = three_pixels(view, center, -1);
  const auto middle = three_pixels(view, center, 0);
  const auto below = three_pixels(view, center, 1);
  PixelPosition last{-1, -1};
  for (std::size_t i = 0; i < count; ++i) {
    const PixelPosition target = targets[i];
    const bool repeated = target == last;
    last = target;
    if (repeated || !HasWholeWindow(neighbour, target)) continue;
    const auto difference = [&](auto own, int row) {
      const auto other = three_pixels(neighbour, target, row);
      return hn::SumsOf8(hn::Or(hn::SaturatedSub(own, other), hn::SaturatedSub(other, own)));
    };
    const auto sums = hn::Add(hn::Add(difference(above, -1), difference(middle, 0)), difference(below, 1));
    const auto sum = static_cast<std::int32_t>(hn::GetLane(hn::SumOfLanes(d64, sums)));
    rewards[i] = static_cast<std::uint16_t>(std::max(0, offset_steps - sum));
  }
}
#endif

}  // namespace depthfarm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace depthfarm {

HWY_EXPORT(ProjectPlanes);
HWY_EXPORT(SumWindows);

void ProjectOntoLine(const EpipolarLine& line, std::span<const double> factors, std::span<PixelPosition> targets) {
  HWY_DYNAMIC_DISPATCH(ProjectPlanes)(line, factors.data(), factors.size(), targets.data());
}

void SumWindows3x3(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center,
                   std::span<const PixelPosition> targets, std::int32_t offset_steps,
                   std::span<std::uint16_t> rewards) {
  HWY_DYNAMIC_DISPATCH(SumWindows)
  (view, neighbour, center, targets.data(), targets.size(), offset_steps, rewards.data());
}

}  // namespace depthfarm
#endif
