#ifndef DEPTHFARM_COORDINATOR_CLI_FARM_SHAPE_H_
#define DEPTHFARM_COORDINATOR_CLI_FARM_SHAPE_H_

namespace depthfarm {

// Worker processes of one machine, and how many tasks each computes at a time.
struct FarmShape {
  int workers = 1;
  int slots = 1;
  bool operator==(const FarmShape&) const = default;
};

// A slot for each of the `cores`, >= 1, which system and other programs leave to this one. `workers`, `slots`: as
// named; 0: not. With neither, up to four slots share a process: what one has decoded the others need not, and where
// few tasks are ready they take the threads of all; a task that ends its worker takes no more than three others along.
// With workers alone they have one slot each.
[[nodiscard]] FarmShape ShapeOfFarm(int workers, int slots, int cores);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_FARM_SHAPE_H_
