#include "worker/transfer/trailing_digest.h"

#include <algorithm>
#include <system_error>

#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

// Between two looks at whether it shall stop.
constexpr std::size_t kStepBytes = std::size_t{1} << 20;

}  // namespace

std::unique_ptr<TrailingDigest> TrailingDigest::Start(const char* bytes, std::size_t total_bytes) {
  try {
    return std::unique_ptr<TrailingDigest>(new TrailingDigest(bytes, total_bytes));
  } catch (const std::system_error&) {
    return nullptr;
  }
}

TrailingDigest::TrailingDigest(const char* bytes, std::size_t total_bytes)
    : bytes_(bytes, total_bytes), thread_([this] { Hash(); }) {}

TrailingDigest::~TrailingDigest() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void TrailingDigest::Advance(std::size_t bytes) {
  {
    const std::scoped_lock lock(mutex_);
    known_ = bytes;
  }
  changed_.notify_all();
}

std::optional<ContentDigest> TrailingDigest::Wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return digest_.has_value(); });
  return digest_;
}

void TrailingDigest::Hash() {
  ArtifactHasher hasher;
  std::size_t hashed = 0;
  while (hashed < bytes_.size()) {
    std::size_t step = 0;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stopping_ || known_ > hashed; });
      if (stopping_) return;
      step = std::min(kStepBytes, known_ - hashed);
    }
    hasher.Update(bytes_.substr(hashed, step));
    hashed += step;
  }
  const std::scoped_lock lock(mutex_);
  digest_ = hasher.Finish();
  changed_.notify_all();
}

}  // namespace depthfarm
