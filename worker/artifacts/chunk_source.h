#ifndef DEPTHFARM_WORKER_ARTIFACTS_CHUNK_SOURCE_H_
#define DEPTHFARM_WORKER_ARTIFACTS_CHUNK_SOURCE_H_

#include <cstdint>

#include "common/base/shared_bytes.h"
#include "common/base/status.h"
#include "common/job/task.h"

namespace depthfarm {

// A piece of an artifact, for peers.
struct ArtifactChunk {
  std::uint64_t total_bytes = 0;
  SharedBytes data;
};

// What an artifact server serves from. Thread-safe.
class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  // Bytes [offset, offset + max_bytes) or as many as there are. Errors: kUnavailable: it is not here; kCorrupt: it is
  // not what it was; kInvalidArgument: an offset past the end.
  [[nodiscard]] virtual Result<ArtifactChunk> ReadChunk(const ArtifactKey& key, std::uint64_t offset,
                                                        std::uint64_t max_bytes) = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_CHUNK_SOURCE_H_
