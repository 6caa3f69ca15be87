#ifndef DEPTHFARM_WORKER_REFINEMENT_PLANE_SOLVER_H_
#define DEPTHFARM_WORKER_REFINEMENT_PLANE_SOLVER_H_

#include <span>

#include "worker/refinement/data_term.h"

namespace depthfarm {

// Moves the planes of the segments that are not kept to where the data term and the agreement of adjacent planes
// balance: each link asks that either plane, extended to the other's centre, meets it there; links across a gap of more
// than `gap_scale` pixels of u or a colour step fade out. Gauss-Seidel, forth and back: the order is fixed, so the
// result is. Threads make the equations; the sweeps are one thread's.
void SolvePlanes(const SegmentMap& map, std::span<const NormalEquations> data, double gap_scale, RefinedView& view,
                 int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PLANE_SOLVER_H_
