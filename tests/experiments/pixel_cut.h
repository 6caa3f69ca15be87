#ifndef DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_CUT_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_CUT_H_

#include <vector>

#include "common/base/status.h"
#include "common/geometry/depth_levels.h"
#include "tests/experiments/pixel_labelling.h"
#include "tests/experiments/two_pair_sgbm.h"

namespace depthfarm {

// Defaults: by PSNR-Y of the virtual view cam2 from cam1 and cam3, mean over two scenes of the tuning list (arc 105 and
// line 114 of scenes_v1.json) at --downscale 2, one step at a time. Tried:
//   window           with 1: -1.1 dB, with 5: -0.8 to -1.1;
//   most_difference  with 30: -1.3 to -2.1; 60, 100 and 765 (no bound, as DERS) are alike;
//   smoothing        0.12: 0, 0.25: -0.3, 0.5: -0.9, 1: -2.0. Outlines grow half as fast as areas, so twice the side
//                    wants twice as much: 0.25 is 0.12 at 640 x 480;
//   most_jump        30 at smoothing 0.25 or 0.5: -0.5 on the whole, but equal outside the plain panel and fewer wrong
//                    pixels; no bound is DERS's choice;
//   the neighbours' mean instead of the smaller difference, smoothing 0.25: -0.5, and 15 % of the pixels off by more
//                    than 1 px instead of 10 %.
struct PixelCutParams {
  int window = 3;               // side of the block that is compared, pixels, odd, 1..15
  double most_difference = 60;  // grey levels, L1 over Y, Cb, Cr: beyond, a match is no worse (occlusion); > 0, <= 765
  double smoothing = 0.25;      // grey levels per 1/249 of the depth range and pair of pixels; 0..100
  double most_jump = 249;       // 1/249 of the depth range: a jump beyond costs no more; >= 1
  int sweeps = 2;

  // kInvalidArgument names the option, its value and its bounds.
  [[nodiscard]] Status Validate() const;
};

// A pixel-level graph cut with the structure of the Depth Estimation Reference Software: per view, for every pixel and
// level the mean colour difference over a block to each neighbour, between pixels (bilinear), the smaller one counting
// (what one neighbour does not see, the other does); |level difference| between 4-neighbours; alpha-expansion over
// the levels from the best level of each pixel. Own z of `view`, no holes but where no level lies in front of the view.
// Memory: 2 bytes per pixel and level, and 120 per pixel. kInvalidArgument: no neighbour, params.
[[nodiscard]] Result<DepthMap> EstimateByPixelCut(const StereoView& view, const std::vector<StereoView>& neighbours,
                                                  const DepthLevels& levels, const PixelCutParams& params);

// What it minimises. The parts must have been checked.
[[nodiscard]] PixelLabelling PixelCutProblem(const StereoView& view, const std::vector<StereoView>& neighbours,
                                             const DepthLevels& levels, const PixelCutParams& params);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_PIXEL_CUT_H_
