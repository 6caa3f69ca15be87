#ifndef DEPTHFARM_WORKER_REFINEMENT_JUMP_BAND_H_
#define DEPTHFARM_WORKER_REFINEMENT_JUMP_BAND_H_

#include <cstdint>

#include "common/image/grid.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// 1 at the pixels at most 4 columns and rows from a depth jump, of half a pixel of u between a pixel and the next in
// its row or column. Where that is more than a quarter of the picture (a thicket), only the higher ones count: those
// above 1, 2, 4, at most 8 pixels of u.
[[nodiscard]] Grid<std::uint8_t> JumpBand(const InverseDepthMap& map, int threads);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_JUMP_BAND_H_
