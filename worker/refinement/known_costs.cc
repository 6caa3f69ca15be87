#include "worker/refinement/known_costs.h"

namespace depthfarm {

KnownCosts::Entry KnownCosts::EntryOf(int x, int y, PlaneIndex plane) {
  std::uint32_t& last = last_(x, y);
  for (std::uint32_t at = last; at != 0; at = costs_[at - 1].before)
    if (costs_[at - 1].plane == plane) return at - 1;
  costs_.push_back({.value = 0, .plane = plane, .before = last});
  places_.push_back({.x = static_cast<std::uint16_t>(x), .y = static_cast<std::uint16_t>(y)});
  last = static_cast<std::uint32_t>(costs_.size());
  return last - 1;
}

}  // namespace depthfarm
