#include "worker/optimization/path_kernels.h"

#include <algorithm>

// This file is compiled once for each kind of vector.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "worker/optimization/path_kernels.cc"
#include <hwy/foreach_target.h>
// The order is Highway's.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace depthfarm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
void Follow(std::int16_t* path, std::size_t levels, int step, const std::int16_t* own, std::int16_t* sum) {
  const std::int16_t least = *std::min_element(path, path + levels);
  int reached = kMostPathCost;
  for (std::size_t level = 0; level < levels; ++level) {
    reached = std::min(path[level] - least, reached + step);
    path[level] = static_cast<std::int16_t>(std::min(reached, kMostPathCost));
  }
  for (std::size_t level = levels; level-- > 0;) {
    reached = std::min(int{path[level]}, reached + step);
    path[level] = static_cast<std::int16_t>(reached + own[level]);
    sum[level] = static_cast<std::int16_t>(sum[level] + path[level]);
  }
}
#else
using Block = hn::FixedTag<std::int16_t, kPathBlock>;
using Costs = hn::Vec<Block>;

// Reached from levels of the block alone, in three doublings: what one, two and four levels farther cost. kUp: from
// lower levels, else from higher ones.
template <bool kUp>
Costs WithinBlock(Costs costs, Costs one, Costs two, Costs four) {
  constexpr Block d;
  if constexpr (kUp) {
    costs = hn::Min(costs, hn::SaturatedAdd(hn::ShiftLeftLanes<1>(d, costs), one));
    costs = hn::Min(costs, hn::SaturatedAdd(hn::ShiftLeftLanes<2>(d, costs), two));
    return hn::Min(costs, hn::SaturatedAdd(hn::ShiftLeftLanes<4>(d, costs), four));
  } else {
    costs = hn::Min(costs, hn::SaturatedAdd(hn::ShiftRightLanes<1>(d, costs), one));
    costs = hn::Min(costs, hn::SaturatedAdd(hn::ShiftRightLanes<2>(d, costs), two));
    return hn::Min(costs, hn::SaturatedAdd(hn::ShiftRightLanes<4>(d, costs), four));
  }
}

void Follow(std::int16_t* path, std::size_t levels, int step, const std::int16_t* own, std::int16_t* sum) {
  constexpr Block d;
  constexpr std::int16_t kNever = 32767;  // what lanes that come from outside the block cost
  HWY_ALIGN static constexpr std::int16_t kFirst[3][kPathBlock] = {
      {kNever, 0, 0, 0, 0, 0, 0, 0}, {kNever, kNever, 0, 0, 0, 0, 0, 0}, {kNever, kNever, kNever, kNever, 0, 0, 0, 0}};
  HWY_ALIGN static constexpr std::int16_t kLast[3][kPathBlock] = {
      {0, 0, 0, 0, 0, 0, 0, kNever}, {0, 0, 0, 0, 0, 0, kNever, kNever}, {0, 0, 0, 0, kNever, kNever, kNever, kNever}};
  HWY_ALIGN static constexpr std::int16_t kFromBelow[kPathBlock] = {1, 2, 3, 4, 5, 6, 7, 8};
  HWY_ALIGN static constexpr std::int16_t kFromAbove[kPathBlock] = {8, 7, 6, 5, 4, 3, 2, 1};

  Costs least = hn::LoadU(d, path);
  for (std::size_t level = kPathBlock; level < levels; level += kPathBlock)
    least = hn::Min(least, hn::LoadU(d, path + level));
  least = hn::Min(least, hn::ShiftRightLanes<4>(d, least));  // lanes that are zero then are not looked at
  least = hn::Min(least, hn::ShiftRightLanes<2>(d, least));
  least = hn::Min(least, hn::ShiftRightLanes<1>(d, least));
  least = hn::Broadcast<0>(least);

  const Costs one = hn::Set(d, static_cast<std::int16_t>(step));
  const Costs two = hn::Add(one, one);
  const Costs four = hn::Add(two, two);
  // Not in arrays: those of SVE have no size.
  const Costs up_one = hn::Or(one, hn::Load(d, kFirst[0]));
  const Costs up_two = hn::Or(two, hn::Load(d, kFirst[1]));
  const Costs up_four = hn::Or(four, hn::Load(d, kFirst[2]));
  const Costs down_one = hn::Or(one, hn::Load(d, kLast[0]));
  const Costs down_two = hn::Or(two, hn::Load(d, kLast[1]));
  const Costs down_four = hn::Or(four, hn::Load(d, kLast[2]));
  const Costs whole = hn::Mul(one, hn::Set(d, kPathBlock));
  const Costs from_below = hn::Mul(one, hn::Load(d, kFromBelow));
  const Costs from_above = hn::Mul(one, hn::Load(d, kFromAbove));

  // From above: path is what it was, less the least; reached what is reached from higher levels.
  Costs carried = hn::Set(d, kNever);  // what the lowest level of the block above costs
  const Costs most = hn::Set(d, kMostPathCost);
  std::int16_t* const reached = path + levels;
  for (std::size_t level = levels; level > 0;) {
    level -= kPathBlock;
    const Costs costs = hn::Min(hn::Sub(hn::LoadU(d, path + level), least), most);
    hn::StoreU(costs, d, path + level);
    const Costs within = WithinBlock<false>(costs, down_one, down_two, down_four);
    hn::StoreU(hn::Min(within, hn::SaturatedAdd(carried, from_above)), d, reached + level);
    carried = hn::Min(hn::Broadcast<0>(within), hn::SaturatedAdd(carried, whole));
  }
  carried = hn::Set(d, kNever);
  for (std::size_t level = 0; level < levels; level += kPathBlock) {
    const Costs within = WithinBlock<true>(hn::LoadU(d, path + level), up_one, up_two, up_four);
    const Costs from_both =
        hn::Min(hn::Min(within, hn::SaturatedAdd(carried, from_below)), hn::LoadU(d, reached + level));
    carried = hn::Min(hn::Broadcast<kPathBlock - 1>(within), hn::SaturatedAdd(carried, whole));
    const Costs all = hn::Add(from_both, hn::LoadU(d, own + level));
    hn::StoreU(all, d, path + level);
    hn::StoreU(hn::Add(hn::LoadU(d, sum + level), all), d, sum + level);
  }
}
#endif

}  // namespace depthfarm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace depthfarm {

HWY_EXPORT(Follow);

void FollowPath(std::span<std::int16_t> path, int step, std::span<const std::int16_t> own,
                std::span<std::int16_t> sum) {
  HWY_DYNAMIC_DISPATCH(Follow)(path.data(), own.size(), step, own.data(), sum.data());
}

}  // namespace depthfarm
#endif
