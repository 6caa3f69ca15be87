#ifndef DEPTHFARM_WORKER_REFINEMENT_VIEW_GEOMETRY_H_
#define DEPTHFARM_WORKER_REFINEMENT_VIEW_GEOMETRY_H_

#include <Eigen/Core>
#include <vector>

#include "common/job/resolved_job.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// How pixels of a view move in one other view: X = (M (x, y, 1) + e u) / q_z, T[.] of eq. (4) (Reprojection) with u of
// SlantedPlane in place of 1/z.
struct PairGeometry {
  int other = 0;  // view index
  Eigen::Matrix3d m;
  Eigen::Vector3d e;
  double other_scale = 1;  // S' / S: u' = other_scale * u / q_z
};

struct ViewGeometry {
  double pixels_per_inverse_depth = 1;  // S, > 0
  std::vector<PairGeometry> pairs;      // with the views of JobView::compared, in their order
};

// S is measured in the first of JobView::compared that shows any parallax, over the picture's centre and corners.
[[nodiscard]] ViewGeometry RefinementGeometry(const ResolvedJob& job, int view);

// The planes of all the job's levels in a view, by level.
[[nodiscard]] std::vector<SlantedPlane> PlanesOfLevels(const ResolvedJob& job, int view, const ViewGeometry& geometry);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_VIEW_GEOMETRY_H_
