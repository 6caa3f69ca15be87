#ifndef DEPTHFARM_WORKER_REFINEMENT_KNOWN_COSTS_H_
#define DEPTHFARM_WORKER_REFINEMENT_KNOWN_COSTS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/image/grid.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// What planes cost at a pixel (PatchCost::At), kept from pass to pass of the choice: there it does not change, and most
// candidates of a pass are those of the pass before. Per pixel the last kKept; memory: 4 bytes for each pixel of the
// picture and 128 for each that ever had a cost.
class KnownCosts {
 public:
  static constexpr std::size_t kKept = 10;

  KnownCosts(int width, int height) : slot_(width, height), pixels_(1) {}

  // nullopt: not known, or forgotten.
  [[nodiscard]] std::optional<double> Find(int x, int y, PlaneIndex plane) const;

  // To be called for what is not known.
  void Keep(int x, int y, PlaneIndex plane, double cost);

 private:
  struct Pixel {
    std::array<PlaneIndex, kKept> planes{};
    std::array<double, kKept> costs{};
    std::uint32_t count = 0;  // ever kept: the next one goes to count % kKept
  };
  Grid<std::uint32_t> slot_;   // of a pixel in pixels_, 0: none yet
  std::vector<Pixel> pixels_;  // [0] knows nothing
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_KNOWN_COSTS_H_
