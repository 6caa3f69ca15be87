#include "worker/artifacts/leaf_digests.h"

#include "common/digest/sha256.h"
#include "worker/artifacts/leaf_lanes.h"

namespace depthfarm {
namespace {

// A lane is slower than the processor's own instructions for SHA-256: with fewer leaves than this one after the other
// is as fast.
constexpr std::size_t kWorthLanes = 6;

}  // namespace

void AppendLeafDigests(std::string_view leaves, std::string& digests) {
  if (leaves.size() >= kWorthLanes * kLeafBytes && AppendInLanes(leaves, digests)) return;
  for (std::size_t at = 0; at < leaves.size(); at += kLeafBytes) {
    const Sha256Digest digest = Sha256(leaves.substr(at, kLeafBytes));
    digests.append(digest.begin(), digest.end());
  }
}

}  // namespace depthfarm
