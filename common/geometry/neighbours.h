#ifndef DEPTHFARM_COMMON_GEOMETRY_NEIGHBOURS_H_
#define DEPTHFARM_COMMON_GEOMETRY_NEIGHBOURS_H_

#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"

namespace depthfarm {

// D of eq. (1): the neighbouring views c' of each view c, at most `max_neighbours` each, nearest first.
//
// The paper takes "the nearest left view and the nearest right view"; arbitrary arrays have no left and right, so the
// choice is by geometry. A candidate must overlap (at least a quarter of a grid of the view's pixels, put on the middle
// level, falls inside it) and look the same way (axes less than 60 degrees apart). Candidates are taken by distance of
// centres, a step along the view's x axis counting 5 % less than one across (so that ties of a grid go left and right),
// in passes that ask for baselines more than 120 degrees apart (left and right on an arc), then 60 degrees (the corner
// of a grid); where more than two neighbours are wanted a last pass takes any direction (two left, two right on an
// arc). So the end view of an arc has one neighbour when two are asked for, as in the paper. The order of `views`, the
// world frame and the unit of length change nothing: ties end with the camera name. Result: one list of indices into
// `views` per view; may be empty (the caller decides whether that is an error).
[[nodiscard]] std::vector<std::vector<int>> ChooseNeighbours(const std::vector<Camera>& views,
                                                             const DepthLevels& levels, int max_neighbours);

// The centre camera of the array: the one with the smallest sum of distances to the others; ties by name. Index into
// views.
[[nodiscard]] int CentreCamera(const std::vector<Camera>& views);

// How far, in pixels of the neighbour, the point of the view's centre pixel travels between the farthest and the
// nearest level plane; 0 where it falls behind the neighbour. Used to choose the number of levels.
[[nodiscard]] double DisparityRange(const Camera& view, const Camera& neighbour, const DepthLevels& levels);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_NEIGHBOURS_H_
