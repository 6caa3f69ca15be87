#ifndef DEPTHFARM_WORKER_REFINEMENT_PLANE_FIELD_H_
#define DEPTHFARM_WORKER_REFINEMENT_PLANE_FIELD_H_

#include <vector>

#include "common/image/grid.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// A slanted segment: u(x, y) = a x + b y + c, exact for planes of the world. u = S / z: pixels of motion in the view's
// nearest neighbour (ViewGeometry::pixels_per_inverse_depth), so that thresholds are pixels whatever the rig.
struct SlantedPlane {
  double a = 0;
  double b = 0;
  double c = 0;
  [[nodiscard]] double At(double x, double y) const { return a * x + b * y + c; }
};

// Refined depth of one view: a plane per segment and the segment of each pixel.
struct RefinedView {
  std::vector<SlantedPlane> planes;
  Grid<SegmentIndex> segment_of_pixel;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PLANE_FIELD_H_
