#ifndef DEPTHFARM_WORKER_COST_UNIQUENESS_H_
#define DEPTHFARM_WORKER_COST_UNIQUENESS_H_

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/depth_levels.h"

namespace depthfarm {

// A change of eq. (5), not in the paper. A segment without texture matches on nearly every level, so its reward says
// nothing, and the optimum of eq. (1) buys such rewards by giving a plain wall the depth of the person in front of it.
// A match is therefore rewarded only by how much it exceeds what most levels reach: its floor, a percentile of the
// rewards of the same segment against the same neighbour over the depth range.

inline constexpr int kFloorPlanes = 32;  // as many windows does a floor cost

// The planes on which floors are measured, as inverse depths in the reference camera (1 / the sequence's unit of
// length; 0 or negative: at or beyond infinity): kFloorPlanes of them, evenly spread over the depth range, the same for
// all parts of a frame whatever levels a part has. Where a point moves less than 32 pixels between the ends of the
// range (`disparity_range`, pixels; 0: not known), they reach as far beyond it as that takes: neighbouring pixels look
// alike, and among three of them even a sharp match is not unique.
[[nodiscard]] std::vector<double> FloorPlanes(const DepthLevels& levels, double disparity_range);

// The floor, in match steps as the rewards (MatchReward): of n rewards, at least 1, the one with floor((n - 1) percent
// / 100) others before it in ascending order. percent: 0..99. Reorders them.
[[nodiscard]] std::uint16_t RewardFloor(std::span<std::uint16_t> rewards, int percent);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_COST_UNIQUENESS_H_
