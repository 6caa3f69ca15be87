#ifndef DEPTHFARM_WORKER_TRANSFER_SERVED_FILES_H_
#define DEPTHFARM_WORKER_TRANSFER_SERVED_FILES_H_

#include <sys/types.h>

#include <cstdint>
#include <ctime>
#include <functional>
#include <map>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/chunk_memory.h"
#include "worker/artifacts/chunk_source.h"

namespace depthfarm {

// Files of this machine as artifacts: the key of each is the SHA-256 of its content. They are served from where they
// are, a piece at a time. Add all before they are served.
class ServedFiles : public ChunkSource {
 public:
  // Reads the file once, for its digests; `stop` is asked in between. Errors: kInvalidArgument: it is no regular file,
  // is empty or larger than 4 GiB; kUnavailable: it cannot be read; kCancelled. All name the path.
  [[nodiscard]] Result<UploadedFile> Add(const std::string& path, const std::function<bool()>& stop);

  // kCorrupt, naming the path, when the file was changed since it was added.
  [[nodiscard]] Result<ArtifactChunk> ReadChunk(const ArtifactKey& key, std::uint64_t offset,
                                                std::uint64_t max_bytes) override;

 private:
  struct File {
    std::string path;
    std::uint64_t bytes = 0;
    timespec changed{};  // its modification time
  };
  ChunkMemory chunk_memory_;
  std::map<ArtifactKey, File> files_;
  std::map<std::string, UploadedFile> added_;  // by path
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_SERVED_FILES_H_
