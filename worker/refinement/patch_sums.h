#ifndef DEPTHFARM_WORKER_REFINEMENT_PATCH_SUMS_H_
#define DEPTHFARM_WORKER_REFINEMENT_PATCH_SUMS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/image/picture.h"
#include "common/job/resolved_job.h"

namespace depthfarm {

// Misfits of one pixel on a plane against each other view; kNotSeen (sight_kernels.h) where that does not see it, or
// there is no such view.
using PixelMisfits = std::array<double, kMostCompared>;

// Where a patch of 3 x 3 pixels is.
struct PatchPlace {
  std::int32_t x = 0;  // of its centre in the picture
  std::int32_t y = 0;
  std::uint32_t cell = 0;  // of its centre among the misfits
};

// Of each patch and view the sum of the misfits of the pixels that the view sees, weighted by ColourWeight with the
// centre, and the sum of these weights.
struct PatchSums {
  PixelMisfits sums{};
  PixelMisfits weights{};
};

// Whether SumPatches can read around the pixel: all nine are inside, and one more column.
[[nodiscard]] inline bool HasWholePatch(const YcbcrImage& picture, const PatchPlace& place) {
  return place.x >= 1 && place.y >= 1 && place.x < picture.width() - 2 && place.y < picture.height() - 1;
}

// The sums of patches with HasWholePatch; others are left alone. The nine misfits of a patch are beside each other in
// `misfits`, rows `stride` apart. On vectors as wide as the processor has; the same bits on all, each sum row by row.
void SumPatches(const YcbcrImage& own, std::span<const PatchPlace> places, std::span<const PixelMisfits> misfits,
                std::size_t stride, std::span<PatchSums> result);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PATCH_SUMS_H_
