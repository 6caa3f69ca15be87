#include "worker/artifacts/chunk_memory.h"

#include <new>
#include <utility>

namespace depthfarm {
namespace {

// All that is kept has this size, that of whole chunks: no byte of it has to be set for the next one. Less comes from
// the allocator as fast.
constexpr std::size_t kKeptBytes = std::size_t{1} << 20;
// A sender that is the slower end takes what came back a moment ago; more are under way only where the receiver is.
constexpr std::size_t kMostKept = 4;

}  // namespace

Result<std::string> ChunkMemory::Take(std::size_t bytes) {
  if (bytes == kKeptBytes) {
    const std::scoped_lock lock(kept_->mutex);
    if (!kept_->strings.empty()) {
      std::string memory = std::move(kept_->strings.back());
      kept_->strings.pop_back();
      return memory;
    }
  }
  try {
    return std::string(bytes, '\0');
  } catch (const std::bad_alloc&) {
    return Unavailable("no memory for a chunk of " + std::to_string(bytes) + " bytes");
  }
}

SharedBytes ChunkMemory::Share(std::string bytes) {
  if (bytes.size() != kKeptBytes) return SharedBytes(std::move(bytes));
  {
    // Where it comes back nothing may throw.
    const std::scoped_lock lock(kept_->mutex);
    kept_->strings.reserve(kMostKept);
  }
  const auto give_back = [kept = kept_](std::string* memory) {
    const std::unique_ptr<std::string> owned(memory);
    const std::scoped_lock lock(kept->mutex);
    if (kept->strings.size() < kMostKept) kept->strings.push_back(std::move(*owned));
  };
  const std::shared_ptr<std::string> owner(new std::string(std::move(bytes)), give_back);
  return {*owner, owner};
}

}  // namespace depthfarm
