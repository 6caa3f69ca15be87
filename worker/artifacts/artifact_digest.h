#ifndef DEPTHFARM_WORKER_ARTIFACTS_ARTIFACT_DIGEST_H_
#define DEPTHFARM_WORKER_ARTIFACTS_ARTIFACT_DIGEST_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/digest/sha256.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// The digest of an artifact's bytes, which come in pieces: SHA-256 of "depthfarm artifact\n", their number (8 bytes,
// little-endian) and the SHA-256 of each leaf, leaves being kLeafBytes long, the last as long as it comes. As hard to
// forge as SHA-256 of the whole, which has to go through one block after the other: leaves are hashed side by side.
class ArtifactHasher {
 public:
  // Whole leaves of one piece are hashed together: give it many at a time.
  void Update(std::string_view bytes);
  // Ends the hash and begins a new one.
  [[nodiscard]] ContentDigest Finish();

 private:
  Sha256Hasher begun_;           // a leaf that came in part
  std::size_t begun_bytes_ = 0;  // of it, less than a leaf
  std::uint64_t total_bytes_ = 0;
  std::string digests_;  // of the leaves before
};

[[nodiscard]] ContentDigest DigestOfArtifact(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_ARTIFACT_DIGEST_H_
