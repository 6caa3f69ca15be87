#ifndef DEPTHFARM_COMMON_JOB_LEVEL_PARTITION_H_
#define DEPTHFARM_COMMON_JOB_LEVEL_PARTITION_H_

#include <vector>

#include "common/geometry/depth_levels.h"
#include "common/job/estimation_params.h"

namespace depthfarm {

// The levels of block `block` of `num_blocks` (paper IV-A, Fig. 2), ascending. Every level belongs to exactly one block
// and sizes differ by at most one. Requires 0 <= block < num_blocks <= num_levels.
[[nodiscard]] std::vector<Level> LevelsOfBlock(int num_levels, int num_blocks, Partition partition, int block);

// One merge of a frame's fixed merge tree (paper IV-A, Fig. 3).
struct MergePair {
  int first = 0;   // index of the first partial result of the round before (round 0: the block)
  int second = 0;  // the one after it, or -1: the odd one out passes on unmerged
  bool operator==(const MergePair&) const = default;
};

// Rounds of merges that turn num_blocks partial results into one: ceil(log2 n) of them, neighbours paired, so that with
// contiguous blocks every merge joins two ranges of levels that touch. Result [round][pair].
[[nodiscard]] std::vector<std::vector<MergePair>> MergeRounds(int num_blocks);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_LEVEL_PARTITION_H_
