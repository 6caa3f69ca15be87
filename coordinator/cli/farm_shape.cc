#include "coordinator/cli/farm_shape.h"

#include <algorithm>

namespace depthfarm {
namespace {

constexpr int kMostSlots = 4;  // unless named

int UsualSlots(int cores) {
  for (int slots = kMostSlots; slots > 1; --slots)
    if (cores % slots == 0) return slots;
  return 1;
}

}  // namespace

FarmShape ShapeOfFarm(int workers, int slots, int cores) {
  if (workers > 0) return {workers, std::max(slots, 1)};
  if (slots <= 0) slots = UsualSlots(cores);
  return {std::max(1, cores / slots), slots};
}

}  // namespace depthfarm
