#ifndef DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_LABELLING_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_LABELLING_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/geometry/depth_levels.h"

namespace depthfarm {

// One level per pixel of a single view:
//
//   E(d) = sum over pixels p of cost(p, d_p) + sum over 4-neighbours p, q of step * min(|d_p - d_q|, most_steps).
//
// The core's LabellingProblem has a target beside every cost, 8 bytes a node and level: too many for pixels.
struct PixelLabelling {
  PixelLabelling(int columns, int rows, int levels)
      : width(columns),
        height(rows),
        num_levels(levels),
        costs(static_cast<std::size_t>(levels) * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  int width;
  int height;
  int num_levels;
  std::vector<std::uint16_t> costs;                  // [level][y][x]
  std::int32_t step = 0;                             // >= 0, step * (num_levels - 1) below 2^28
  int most_steps = std::numeric_limits<int>::max();  // >= 1

  [[nodiscard]] std::size_t num_pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] std::uint16_t* CostsOf(int level) {
    return costs.data() + static_cast<std::size_t>(level) * num_pixels();
  }
  [[nodiscard]] const std::uint16_t* CostsOf(int level) const {
    return costs.data() + static_cast<std::size_t>(level) * num_pixels();
  }
};

[[nodiscard]] std::int64_t TotalEnergy(const PixelLabelling& problem, const std::vector<Level>& labels);

// Winner takes all: each pixel's level of least cost, the farthest of equals.
[[nodiscard]] std::vector<Level> CheapestLevels(const PixelLabelling& problem);

// Alpha-expansion with the core's MaxFlow and in the core's order (SearchFully): sweeps over the levels up and
// down in turn, at most `sweeps` (0: until no move lowers E); of equal labellings the one that changes fewest pixels.
// Returns E, never more than that of the labels it was given.
std::int64_t ExpandPixels(const PixelLabelling& problem, int sweeps, std::vector<Level>& labels);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_LABELLING_H_
