#ifndef DEPTHFARM_COMMON_CALIBRATION_ROBUST_RANGE_H_
#define DEPTHFARM_COMMON_CALIBRATION_ROBUST_RANGE_H_

#include <vector>

#include "common/base/status.h"
#include "common/geometry/depth_levels.h"

namespace depthfarm {

// A depth range for what reconstructed points show, some of which are wrong and which lie on textured parts alone: from
// the 1st to the 99th percentile of those in front of the camera, with 1/z a tenth more at the near end and a fifth
// less at the far one. Depths are of any order; those <= 0 or not finite do not count.
// kInvalidArgument: fewer than 20 count.
[[nodiscard]] Result<DepthRange> RobustRange(std::vector<float> depths);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_ROBUST_RANGE_H_
