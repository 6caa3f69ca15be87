#ifndef DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_CHECKS_H_
#define DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_CHECKS_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"

namespace depthfarm {

// How the cameras of an array stand, as far as one look tells whether a calibration was understood.
struct ArrayOverview {
  std::string nearest;        // the camera nearest to the reference; "": there is no other
  double baseline = 0;        // between the two, the sequence's unit of length
  double disparity_near = 0;  // between the two, about, pixels: focal length * baseline / z
  double disparity_far = 0;
  std::vector<std::string> lonely;  // cameras that see the scene as no other one does: run refuses them
};

// Looks at `cameras`, of which `reference` is an index; `range` is that of the reference.
// Errors (kInvalidArgument): the range is none; there are several cameras, and all are at one place or no two of them
// see the same part of the scene: the calibration was meant otherwise, or the range has another unit.
[[nodiscard]] Result<ArrayOverview> LookAtArray(const std::vector<Camera>& cameras, std::size_t reference,
                                                const DepthRange& range);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_CHECKS_H_
