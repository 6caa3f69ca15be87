#ifndef DEPTHFARM_TESTS_EXPERIMENTS_COST_MARGIN_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_COST_MARGIN_H_

#include <cstdint>
#include <string>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "tests/experiments/pixel_labelling.h"

namespace depthfarm {

// What confidence is compared with: by how much the best level of a pixel beats the second best local minimum of its
// raw matching costs, as a code that grows with it (0: not at all).
[[nodiscard]] Grid<std::uint16_t> CostMargins(const PixelLabelling& problem);

// Copies the depth of `depth_dir` to `output` with these margins (3 x 3 pixels, the better of the two neighbours, as
// the pixel-level cut) as its confidence. kInvalidArgument: folders that can't be read or don't fit together.
[[nodiscard]] Status WriteWithCostMargins(const std::string& sequence_file, const std::string& depth_dir,
                                          const std::string& output);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_COST_MARGIN_H_
