#ifndef DEPTHFARM_WORKER_ARTIFACTS_LEAF_LANES_H_
#define DEPTHFARM_WORKER_ARTIFACTS_LEAF_LANES_H_

#include <string>
#include <string_view>

namespace depthfarm {

// As AppendLeafDigests, many leaves side by side, one in each lane of the vectors that the processor has. False, and
// nothing is appended, where there is no libipsec-mb, which knows x86-64 alone, or it lacks memory.
[[nodiscard]] bool AppendInLanes(std::string_view leaves, std::string& digests);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_LEAF_LANES_H_
