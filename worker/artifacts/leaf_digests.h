#ifndef DEPTHFARM_WORKER_ARTIFACTS_LEAF_DIGESTS_H_
#define DEPTHFARM_WORKER_ARTIFACTS_LEAF_DIGESTS_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace depthfarm {

// Of the tree of an artifact's digest (artifact_digest.h). What libipsec-mb hashes at a time is less than 64 KiB.
inline constexpr std::size_t kLeafBytes = std::size_t{32} << 10;

// SHA-256 of each leaf of `leaves`, whose size is a multiple of kLeafBytes: 32 bytes each, behind `digests`. Many are
// hashed side by side where that is possible (leaf_lanes.h), else one after the other. The same digests.
void AppendLeafDigests(std::string_view leaves, std::string& digests);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_LEAF_DIGESTS_H_
