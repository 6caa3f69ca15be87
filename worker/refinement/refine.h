#ifndef DEPTHFARM_WORKER_REFINEMENT_REFINE_H_
#define DEPTHFARM_WORKER_REFINEMENT_REFINE_H_

#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "common/base/status.h"
#include "common/job/resolved_job.h"
#include "worker/estimation/estimation.h"
#include "worker/refinement/plane_field.h"
#include "worker/refinement/view_memory.h"

namespace depthfarm {

// The refined depth of all views of a frame, in the job's order.
using FrameRefinement = std::vector<std::shared_ptr<const RefinedView>>;

// One frame that a P frame refers to (paper III-E), of the view that is refined.
struct ReferenceView {
  std::shared_ptr<const ViewAnalysis> analysis;
  std::shared_ptr<const RefinedView> refined;  // after its last round
};
struct RefinementReferences {
  ReferenceView previous;
  ReferenceView i_frame;
};

// Round 0 of a view: the planes of its segments' levels. Of a P frame (`references` is null for I frames) unchanged
// segments have the refined depth of their reference instead, pixel by pixel, and keep it; others take a plane of the
// frame before from around them where one is on their level (StartFromAround).
// Errors: kInvalidArgument: parts that do not fit each other or the job, a picture of less than 2 x 2 pixels.
[[nodiscard]] Result<RefinedView> StartRefinement(const ResolvedJob& job, int view, const ViewAnalysis& analysis,
                                                  const ViewLabels& labels, const RefinementReferences* references);

// What a round found, for status.
struct RefinementStats {
  bool prior_left_aside = false;  // of the last round: the view's prior is trusted at hardly any segment
};

// How a round runs; what it computes does not depend on it.
struct RefinementRun {
  std::stop_token stop = {};
  RefinementStats* stats = nullptr;  // filled where given
  int threads = 1;
};

// Round `round` (1 .. params.refine_rounds) of a view: Gauss-Newton on the colour differences against the views it is
// compared with (JobView::compared), one slanted plane per segment; the first round on smoothed pictures (unless pixels
// choose in it), after surfaces without texture have been decided as a whole, the last params.choice_rounds on sharp
// ones and also with agreement with the depth of those views and a choice of plane for each pixel at depth jumps.
// `analysis` and `before` (each view after the round before) are read for the view and those it is compared with; the
// others may be null. So all views of a round can be refined at once, in any order; one after the other with the same
// `memory` saves time. The result is the same on any number of threads. Errors: as StartRefinement; kCancelled.
[[nodiscard]] Result<RefinedView> RefineView(const ResolvedJob& job, int view, int round, const FrameAnalysis& analysis,
                                             const FrameRefinement& before, ViewMemory& memory,
                                             const RefinementRun& run = {});
[[nodiscard]] Result<RefinedView> RefineView(const ResolvedJob& job, int view, int round, const FrameAnalysis& analysis,
                                             const FrameRefinement& before, const RefinementRun& run = {});

// Depth codes of the view's files (as DepthCodes): 0 more than a pixel of u behind infinity, where no plane is in front
// of the view; else within the view's own range.
[[nodiscard]] Grid<std::uint16_t> RefinedDepthCodes(const ResolvedJob& job, int view, const RefinedView& refined);

// kInvalidArgument unless `view` is one of the job's and it and those it is compared with have analysis and depth that
// fit their cameras and each other; names the camera.
[[nodiscard]] Status CheckViewInputs(const ResolvedJob& job, int view, const FrameAnalysis& analysis,
                                     const FrameRefinement& refined);

// kInvalidArgument unless `refined` fits the segments of `analysis`.
[[nodiscard]] Status CheckRefined(const ViewAnalysis& analysis, const RefinedView& refined);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_REFINE_H_
