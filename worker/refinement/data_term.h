#ifndef DEPTHFARM_WORKER_REFINEMENT_DATA_TERM_H_
#define DEPTHFARM_WORKER_REFINEMENT_DATA_TERM_H_

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "worker/refinement/free_pixels.h"
#include "worker/refinement/other_view.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Normal equations of one segment in (a, b, u at the centre), for the change of its plane: H (6: aa ab ac bb bc cc).
struct NormalEquations {
  std::array<double, 6> h{};
  std::array<double, 3> rhs{};
};

// Gauss-Newton on the colour differences of the free pixels of each segment against each other
// view, of which every second one speaks for two, every fourth of smoothed pictures for four; an other view that does
// not fit a segment (a silhouette) counts less there. `free` is FreePixels(refined), `map` is refined.Map(),
// `centers` has one per segment, and so has the result; that of kept ones is 0. `blurred`:
// all colours are smoothed, so neighbouring differences are not independent. Threads take one other view each, so that
// sums are in one order. Ends early with a part of the sum once `stop` is requested.
[[nodiscard]] std::vector<NormalEquations> DataTerm(const PictureColours& own, const RefinedView& refined,
                                                    const FreePixels& free, const InverseDepthMap& map,
                                                    std::span<const PixelPosition> centers,
                                                    std::span<const OtherView> others, bool blurred,
                                                    const std::stop_token& stop = {}, int threads = 1);

// Draws the plane of each segment that is not kept, at its centre, to the depth that the other views have where it is
// seen, unless that is far off (more than about half a pixel of u) or at a jump there.
void AddAgreement(const RefinedView& refined, std::span<const PixelPosition> centers, std::span<const OtherView> others,
                  std::vector<NormalEquations>& equations, int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_DATA_TERM_H_
