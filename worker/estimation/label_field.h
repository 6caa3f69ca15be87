#ifndef DEPTHFARM_WORKER_ESTIMATION_LABEL_FIELD_H_
#define DEPTHFARM_WORKER_ESTIMATION_LABEL_FIELD_H_

#include <cstdint>
#include <vector>

#include "common/geometry/depth_levels.h"

namespace depthfarm {

// d of eq. (1) for one view: one depth level per segment.
struct ViewLabels {
  std::vector<Level> levels;            // per segment, of all the job's levels (not of a block)
  std::vector<std::uint8_t> unchanged;  // per segment: 1 = depth adopted from a reference frame (III-E): no node
  bool operator==(const ViewLabels&) const = default;
};

// d of eq. (1) for all views of a job, in their order.
struct LabelField {
  std::vector<ViewLabels> views;
  bool operator==(const LabelField&) const = default;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ESTIMATION_LABEL_FIELD_H_
