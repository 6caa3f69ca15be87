#ifndef DEPTHFARM_WORKER_ARTIFACTS_MEMORY_CACHE_H_
#define DEPTHFARM_WORKER_ARTIFACTS_MEMORY_CACHE_H_

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <variant>

#include "common/job/task.h"
#include "worker/confidence/confidence.h"
#include "worker/estimation/label_field.h"
#include "worker/refinement/plane_field.h"
#include "worker/segmentation/analysis.h"

namespace depthfarm {

// Bytes an object occupies in memory, its vectors included.
[[nodiscard]] std::uint64_t MemoryBytes(const ViewAnalysis& analysis);
[[nodiscard]] std::uint64_t MemoryBytes(const LabelField& field);
[[nodiscard]] std::uint64_t MemoryBytes(const RefinedView& view);
[[nodiscard]] std::uint64_t MemoryBytes(const ConfidenceMap& map);

// Decoded artifacts by key, so that the blocks of a frame on one worker share its analysis instead of decoding it anew.
// Bounded by the bytes of what it holds: the least recently used goes first, and an object larger than the bound is not
// kept. Objects that a task still uses live on outside the bound after they were evicted.
// Every function may be called from any thread.
class MemoryCache {
 public:
  explicit MemoryCache(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}

  // T: ViewAnalysis, LabelField, RefinedView or ConfidenceMap.
  template <typename T>
  void Put(const ArtifactKey& key, std::shared_ptr<const T> object) {
    const std::uint64_t bytes = MemoryBytes(*object);
    Insert(key, std::move(object), bytes);
  }
  // Null when it is not here, or is another kind of object.
  template <typename T>
  [[nodiscard]] std::shared_ptr<const T> Find(const ArtifactKey& key) {
    const std::scoped_lock lock(mutex_);
    const Object* object = Use(key);
    const auto* found = object == nullptr ? nullptr : std::get_if<std::shared_ptr<const T>>(object);
    return found == nullptr ? nullptr : *found;
  }
  void Erase(const ArtifactKey& key);

  [[nodiscard]] std::uint64_t total_bytes() const;

 private:
  using Object = std::variant<std::shared_ptr<const ViewAnalysis>, std::shared_ptr<const LabelField>,
                              std::shared_ptr<const RefinedView>, std::shared_ptr<const ConfidenceMap>>;
  struct Entry {
    ArtifactKey key{};
    Object object;
    std::uint64_t bytes = 0;
  };
  void Insert(const ArtifactKey& key, Object object, std::uint64_t bytes);
  // The functions below require the mutex.
  void Remove(const ArtifactKey& key);
  // Marks the entry as used; null when there is none.
  [[nodiscard]] const Object* Use(const ArtifactKey& key);

  const std::uint64_t max_bytes_;
  mutable std::mutex mutex_;
  std::uint64_t total_bytes_ = 0;
  std::list<Entry> used_;  // least recently used first
  std::map<ArtifactKey, std::list<Entry>::iterator> entries_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_MEMORY_CACHE_H_
