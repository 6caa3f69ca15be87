#ifndef DEPTHFARM_WORKER_COST_MATCH_KERNELS_H_
#define DEPTHFARM_WORKER_COST_MATCH_KERNELS_H_

#include <array>
#include <cstdint>
#include <span>

#include "common/image/picture.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// The loops that fill a frame's matches, on vectors as wide as the processor has (Highway chooses at run time). They
// give the same bits on all: floating point is one operation a step on each lane, sums are integers.

// Where a pixel of one view can be in another: (qx, qy, qz) = at_infinity + per_inverse_depth / z, pixel (qx, qy) / qz.
struct EpipolarLine {
  std::array<double, 3> at_infinity{};
  std::array<double, 3> per_inverse_depth{};
  double slope = 0;  // 1/z is slope times a plane's factor
  int width = 0;     // of the other view's picture, pixels
  int height = 0;
};

// The nearest pixel on each plane (their factors); (-1, -1) where that is behind the other view or outside its picture,
// or the factor not a number. targets: as many as factors.
void ProjectOntoLine(const EpipolarLine& line, std::span<const double> factors, std::span<PixelPosition> targets);

// Whether SumWindows3x3 can read around the pixel: all nine samples are inside, and one more column.
[[nodiscard]] inline bool HasWholeWindow(const YcbcrImage& picture, PixelPosition pixel) {
  return pixel.x >= 1 && pixel.y >= 1 && pixel.x < picture.width() - 2 && pixel.y < picture.height() - 1;
}

// max(0, offset_steps - sum), the sum over 3x3 pixels of the L1 difference of Y, Cb, Cr, for each target with
// HasWholeWindow that is not the one before it; other rewards are left alone. Of `center` it must hold.
void SumWindows3x3(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center,
                   std::span<const PixelPosition> targets, std::int32_t offset_steps, std::span<std::uint16_t> rewards);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_COST_MATCH_KERNELS_H_
