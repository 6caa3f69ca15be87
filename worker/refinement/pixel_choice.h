#ifndef DEPTHFARM_WORKER_REFINEMENT_PIXEL_CHOICE_H_
#define DEPTHFARM_WORKER_REFINEMENT_PIXEL_CHOICE_H_

#include <span>
#include <stop_token>

#include "worker/refinement/other_view.h"
#include "worker/refinement/prior_field.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Gives each pixel near a depth jump (JumpBand) the one of the planes around it whose colours fit the other views best,
// so that depth edges follow the picture's and not the segments'. Pass by pass planes spread from pixel to pixel, along
// a rod that most of its segments have missed, until nothing changes. Pixels of kept segments (`segments` names them)
// stay as they are; `map` is view.Map(). A prior (null: none) speaks for the plane nearest to it. Ends early, with some
// pixels not chosen, once `stop` is requested. Threads find and weigh the planes, each in bands of rows; choosing,
// where a pixel asks those before it, is one thread's.
void ChoosePlanes(const YcbcrImage& own, const Grid<SegmentIndex>& segments, const InverseDepthMap& map,
                  std::span<const OtherView> others, const PriorField* prior, RefinedView& view,
                  const std::stop_token& stop = {}, int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PIXEL_CHOICE_H_
