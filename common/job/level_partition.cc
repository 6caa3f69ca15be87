#include "common/job/level_partition.h"

#include <cstddef>

namespace depthfarm {

std::vector<Level> LevelsOfBlock(int num_levels, int num_blocks, Partition partition, int block) {
  std::vector<Level> levels;
  if (partition == Partition::kInterleaved) {
    for (int level = block; level < num_levels; level += num_blocks) levels.push_back(static_cast<Level>(level));
    return levels;
  }
  const int begin = static_cast<int>(static_cast<long long>(num_levels) * block / num_blocks);
  const int end = static_cast<int>(static_cast<long long>(num_levels) * (block + 1) / num_blocks);
  for (int level = begin; level < end; ++level) levels.push_back(static_cast<Level>(level));
  return levels;
}

std::vector<std::vector<MergePair>> MergeRounds(int num_blocks) {
  std::vector<std::vector<MergePair>> rounds;
  for (int count = num_blocks; count > 1; count = (count + 1) / 2) {
    std::vector<MergePair> pairs;
    for (int first = 0; first < count; first += 2) pairs.push_back({first, first + 1 < count ? first + 1 : -1});
    rounds.push_back(pairs);
  }
  return rounds;
}

}  // namespace depthfarm
