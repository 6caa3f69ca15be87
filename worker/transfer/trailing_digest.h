#ifndef DEPTHFARM_WORKER_TRANSFER_TRAILING_DIGEST_H_
#define DEPTHFARM_WORKER_TRANSFER_TRAILING_DIGEST_H_

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "common/job/task_spec.h"

namespace depthfarm {

// The digest of an artifact (artifact_digest.h) whose bytes come to be known from the front on, computed on a thread of
// its own behind whoever fills them: hashing takes as long as all else that is done to a chunk that arrives. For one
// filling thread.
class TrailingDigest {
 public:
  // Reads `total_bytes` from `bytes` on, each when it is known. They must stay where they are as long as this lives.
  // Null when there is no thread to be had.
  [[nodiscard]] static std::unique_ptr<TrailingDigest> Start(const char* bytes, std::size_t total_bytes);
  // Stops within a step, a millisecond.
  ~TrailingDigest();
  TrailingDigest(const TrailingDigest&) = delete;
  TrailingDigest& operator=(const TrailingDigest&) = delete;

  // The first `bytes` are known now, and do not change any more. Never fewer than before.
  void Advance(std::size_t bytes);
  // The digest of all; none when it is not there within `timeout`.
  [[nodiscard]] std::optional<ContentDigest> Wait(std::chrono::milliseconds timeout);

 private:
  TrailingDigest(const char* bytes, std::size_t total_bytes);
  void Hash();

  const std::string_view bytes_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t known_ = 0;
  bool stopping_ = false;
  std::optional<ContentDigest> digest_;
  std::thread thread_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_TRAILING_DIGEST_H_
