#ifndef DEPTHFARM_WORKER_REFINEMENT_PIXEL_CHOICE_H_
#define DEPTHFARM_WORKER_REFINEMENT_PIXEL_CHOICE_H_

#include <span>

#include "worker/refinement/other_view.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Gives each pixel near a depth jump the one of the planes around it whose colours fit the other views best, so that
// depth edges follow the picture's and not the segments'. Pixels of kept segments (`segments` names them) stay as they
// are. Where most of the picture is jumps (a thicket), only the higher ones count.
void ChoosePlanes(const ColourGrid& own, const Grid<SegmentIndex>& segments, std::span<const OtherView> others,
                  RefinedView& view);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PIXEL_CHOICE_H_
