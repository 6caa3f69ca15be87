#ifndef DEPTHFARM_WORKER_CONFIDENCE_CONFIDENCE_H_
#define DEPTHFARM_WORKER_CONFIDENCE_CONFIDENCE_H_

#include <cstdint>
#include <stop_token>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/job/resolved_job.h"
#include "worker/refinement/refine.h"

namespace depthfarm {

inline constexpr double kConfidenceScale = 65535;

// How likely the depth of each pixel of a view is right: off by at most a pixel of motion in the view's nearest
// neighbour.
struct ConfidenceMap {
  Grid<std::uint16_t> codes;  // H x W; probability times kConfidenceScale
  bool operator==(const ConfidenceMap&) const = default;
};

// What there is for and against the depth of a pixel.
struct Evidence {
  double misfit = 0.5;          // of its colour and its neighbours' in the better half of the other views, 0 to 1
  double margin = 0;            // by how much that grows 2 px of u nearer or farther, where it grows least; >= 0
  int agreeing = 0;             // other views that see it and have it at the same depth, to half a pixel of u
  bool seen_through = false;    // some other view has nothing but what is farther there
  double nearest_gap = 1;       // pixels of u to the other view that agrees best, at most 1; 1 where none sees it
  double mean_gap = 0;          // over the other views that see it, at most 1; 0 where none does
  int to_jump = kFarFromJumps;  // pixels to the nearest depth jump in this view, at most kFarFromJumps
  static constexpr int kFarFromJumps = 5;
};

// Probability that depth with this evidence is right, 0 to 1.
[[nodiscard]] double ProbabilityOfRight(const Evidence& evidence);

// The confidence of a view's refined depth. `analysis` and `refined` (after the last round) are read for the view and
// those it is compared with (JobView::compared); the others may be null. Equal input, equal bytes.
// Errors: as RefineView.
[[nodiscard]] Result<ConfidenceMap> AssessView(const ResolvedJob& job, int view, const FrameAnalysis& analysis,
                                               const FrameRefinement& refined, const std::stop_token& stop = {});

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_CONFIDENCE_CONFIDENCE_H_
