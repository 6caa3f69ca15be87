#ifndef DEPTHFARM_WORKER_ARTIFACTS_CHUNK_MEMORY_H_
#define DEPTHFARM_WORKER_ARTIFACTS_CHUNK_MEMORY_H_

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/shared_bytes.h"
#include "common/base/status.h"

namespace depthfarm {

// Memory of chunks that have been sent, for those that come next: the pages of a fresh MiB cost as much as reading a
// file into them. Keeps at most 4 MiB. Thread-safe; may end before what it shared does.
class ChunkMemory {
 public:
  ChunkMemory() : kept_(std::make_shared<Kept>()) {}

  // Of that size; what is in it has no meaning. One of 1 MiB comes from what is kept, if there is any. Errors:
  // kUnavailable: there is no memory.
  [[nodiscard]] Result<std::string> Take(std::size_t bytes);
  // Comes back when its last holder lets it go.
  [[nodiscard]] SharedBytes Share(std::string bytes);

 private:
  struct Kept {
    std::mutex mutex;
    std::vector<std::string> strings;
  };
  std::shared_ptr<Kept> kept_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_CHUNK_MEMORY_H_
