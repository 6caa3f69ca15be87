#ifndef DEPTHFARM_WORKER_OPTIMIZATION_PATH_KERNELS_H_
#define DEPTHFARM_WORKER_OPTIMIZATION_PATH_KERNELS_H_

#include <cstddef>
#include <cstdint>
#include <span>

namespace depthfarm {

// Costs of paths over levels an equal way apart, in 16 bits, on vectors (Highway chooses at run time): the same
// integers on all of them. Rows of costs are a whole number of blocks of kPathBlock levels; those behind the last level
// cost at least as much as it does, and then never decide anything.
inline constexpr std::size_t kPathBlock = 8;
inline constexpr int kMostPathCost = 4000;  // four of them and three rewards fit

// Takes a path from one node to the next: path[l] = own[l] + min over l' of (path[l'] + step |l - l'|), less the least
// path[l'], at most kMostPathCost without own; and adds it to sum[l]. 0 <= step <= kMostPathCost. own and sum are as
// long; path is twice as long, the second half room to work.
void FollowPath(std::span<std::int16_t> path, int step, std::span<const std::int16_t> own, std::span<std::int16_t> sum);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_OPTIMIZATION_PATH_KERNELS_H_
