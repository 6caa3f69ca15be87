#ifndef DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_CUT_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_CUT_H_

#include <vector>

#include "common/base/status.h"
#include "common/geometry/depth_levels.h"
#include "tests/experiments/two_pair_sgbm.h"

namespace depthfarm {

// The best of differences 30, 60, 100 and smoothings 0.12, 0.25, 0.5, 1 for the virtual view of the arcs of seeds 1 and
// 2, 400 x 300.
struct PixelCutParams {
  double most_difference = 60;  // grey levels, L1 over Y, Cb, Cr: beyond, a match is no worse (occlusion)
  double smoothing = 0.5;       // grey levels per 1/249 of the depth range and pair of pixels
  int sweeps = 2;
};

// A pixel-level graph cut with the structure of the Depth Estimation Reference Software: per view, for every pixel and
// level the colour difference over 3 x 3 pixels to each neighbour, between pixels (bilinear), the smaller one counting
// (what one neighbour does not see, the other does); |level difference| between 4-neighbours; alpha-expansion over
// the levels from the best level of each pixel. Own z of `view`, no holes but where no level lies in front of the view.
// Memory: 8 bytes per pixel and level. kInvalidArgument: no neighbour.
[[nodiscard]] Result<DepthMap> EstimateByPixelCut(const StereoView& view, const std::vector<StereoView>& neighbours,
                                                  const DepthLevels& levels, const PixelCutParams& params);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_CUT_H_
