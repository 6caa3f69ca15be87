#ifndef DEPTHFARM_WORKER_REFINEMENT_VIEW_GEOMETRY_H_
#define DEPTHFARM_WORKER_REFINEMENT_VIEW_GEOMETRY_H_

#include <vector>

#include "common/job/resolved_job.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// How pixels of a view move in one other view: X = (M (x, y, 1) + e u) / q_z, u as in SlantedPlane.
struct PairGeometry {
  int other = 0;           // view index
  double m[3][3] = {};     // M
  double e[3] = {};        // e / S
  double other_scale = 1;  // S' / S: u' = other_scale * u / q_z
};

struct ViewGeometry {
  double pixels_per_inverse_depth = 1;  // S, > 0
  double u_near = 0;                    // u of the view's own range
  double u_far = 0;
  std::vector<PairGeometry> pairs;  // at most four views that see what it sees, nearest first
};

// One per view of the job.
[[nodiscard]] std::vector<ViewGeometry> RefinementGeometry(const ResolvedJob& job);

// The plane of the level in u.
[[nodiscard]] SlantedPlane PlaneOfLevel(const ResolvedJob& job, int view, const ViewGeometry& geometry, Level level);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_VIEW_GEOMETRY_H_
