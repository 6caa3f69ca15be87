#ifndef DEPTHFARM_WORKER_REFINEMENT_KNOWN_COSTS_H_
#define DEPTHFARM_WORKER_REFINEMENT_KNOWN_COSTS_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/image/grid.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// What planes cost at pixels (PatchCost::At), kept from pass to pass of the choice: there it does not change, and most
// candidates of a pass are those of the pass before. Memory: 4 bytes for each pixel of the picture and 20 for each
// cost: at most 5 candidates in 40 passes, in fact about 5 to 10 for each pixel near a jump.
class KnownCosts {
 public:
  using Entry = std::uint32_t;  // 0 .. size() - 1, in the order in which they were asked for

  struct Cost {
    double value = 0;
    PlaneIndex plane = 0;
    std::uint32_t before = 0;  // 1 + the entry of the same pixel before this one; 0: none
  };
  // The pixel of an entry.
  struct Place {
    std::uint16_t x = 0;  // sides are at most kMaxPictureSide
    std::uint16_t y = 0;
  };

  KnownCosts(int width, int height) : last_(width, height) {}

  // The entry of a plane at a pixel: a new one, of cost 0, where there is none.
  [[nodiscard]] Entry EntryOf(int x, int y, PlaneIndex plane);

  void Reserve(std::size_t costs) {
    costs_.reserve(costs);
    places_.reserve(costs);
  }

  [[nodiscard]] std::size_t size() const { return costs_.size(); }
  [[nodiscard]] const Cost& operator[](Entry entry) const { return costs_[entry]; }
  [[nodiscard]] Place PlaceOf(Entry entry) const { return places_[entry]; }
  void Set(Entry entry, double cost) { costs_[entry].value = cost; }

 private:
  Grid<std::uint32_t> last_;  // 1 + the last entry of a pixel; 0: none
  std::vector<Cost> costs_;
  std::vector<Place> places_;  // of each, apart: they are asked for once, costs in every pass
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_KNOWN_COSTS_H_
