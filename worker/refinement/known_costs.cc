#include "worker/refinement/known_costs.h"

#include <algorithm>

namespace depthfarm {

std::optional<double> KnownCosts::Find(int x, int y, PlaneIndex plane) const {
  const Pixel& pixel = pixels_[slot_(x, y)];
  const auto known = static_cast<std::ptrdiff_t>(std::min<std::size_t>(pixel.count, kKept));
  const auto at = std::find(pixel.planes.begin(), pixel.planes.begin() + known, plane);
  if (at == pixel.planes.begin() + known) return std::nullopt;
  return pixel.costs[static_cast<std::size_t>(at - pixel.planes.begin())];
}

void KnownCosts::Keep(int x, int y, PlaneIndex plane, double cost) {
  std::uint32_t& slot = slot_(x, y);
  if (slot == 0) {
    slot = static_cast<std::uint32_t>(pixels_.size());
    pixels_.emplace_back();
  }
  Pixel& pixel = pixels_[slot];
  const std::size_t next = pixel.count++ % kKept;
  pixel.planes[next] = plane;
  pixel.costs[next] = cost;
}

}  // namespace depthfarm
