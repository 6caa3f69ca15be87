#ifndef DEPTHFARM_TESTS_SYSTEM_GATED_FILES_H_
#define DEPTHFARM_TESTS_SYSTEM_GATED_FILES_H_

#include <atomic>
#include <cstdint>
#include <string>

#include "worker/transfer/artifact_server.h"
#include "worker/transfer/served_files.h"

namespace depthfarm::system_test {

// Pictures as the submitter of a job serves them, but that one of them is not there before the test says so: whoever
// analyses it is busy until then.
class GatedFiles : public ChunkSource {
 public:
  [[nodiscard]] UploadedFile Add(const std::string& path) {
    return files_.Add(path, [] { return false; }).value();
  }
  void Gate(const ArtifactKey& key) { gated_ = key; }
  void Open() { open_ = true; }

  [[nodiscard]] Result<ArtifactChunk> ReadChunk(const ArtifactKey& key, std::uint64_t offset,
                                                std::uint64_t max_bytes) override {
    if (key == gated_) {
      asked_for_ = true;
      if (!open_) return Unavailable("not yet");
    }
    return files_.ReadChunk(key, offset, max_bytes);
  }
  [[nodiscard]] bool asked_for() const { return asked_for_; }

 private:
  ServedFiles files_;
  ArtifactKey gated_{};
  std::atomic<bool> open_ = false;
  std::atomic<bool> asked_for_ = false;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_GATED_FILES_H_
