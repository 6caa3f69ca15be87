#include "common/digest/sha256.h"
#include "worker/artifacts/leaf_digests.h"

namespace depthfarm {

void AppendLeafDigests(std::string_view leaves, std::string& digests) {
  for (std::size_t at = 0; at < leaves.size(); at += kLeafBytes) {
    const Sha256Digest digest = Sha256(leaves.substr(at, kLeafBytes));
    digests.append(digest.begin(), digest.end());
  }
}

}  // namespace depthfarm
