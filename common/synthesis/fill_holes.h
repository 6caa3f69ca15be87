#ifndef DEPTHFARM_COMMON_SYNTHESIS_FILL_HOLES_H_
#define DEPTHFARM_COMMON_SYNTHESIS_FILL_HOLES_H_

#include <cstdint>

#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// Fills the pixels that no source saw, from the known pixels met first in the eight directions, weighted by nearness
// (1 / squared distance). What a moving camera uncovers is background: a hole that lies between known pixels (some
// direction and its opposite both meet one) takes only those within 5 % of the farthest depth. A hole beyond the border
// of what the sources saw continues what is beside it, near or far. `kinds` tells what is known:
enum class Known : std::uint8_t {
  kHole = 0,      // filled
  kDoubtful = 1,  // filled too where a clean pixel is in reach, else kept: a background pixel that may hold foreground
  kClean = 2,     // kept; the only kind that fills others
};
// All three have one size. Without any clean pixel the doubtful ones serve; without those nothing changes.
void FillHoles(const Grid<Known>& kinds, YcbcrImage& picture, DepthMap& depth);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SYNTHESIS_FILL_HOLES_H_
