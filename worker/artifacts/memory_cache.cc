#include "worker/artifacts/memory_cache.h"

#include <vector>

namespace depthfarm {
namespace {

template <typename T>
std::uint64_t VectorBytes(const std::vector<T>& vector) {
  return vector.capacity() * sizeof(T);
}

}  // namespace

std::uint64_t MemoryBytes(const ViewAnalysis& analysis) {
  const SegmentMap& segments = analysis.segments;
  return sizeof(ViewAnalysis) + VectorBytes(analysis.picture.values()) + VectorBytes(segments.labels.values()) +
         VectorBytes(segments.centers) + VectorBytes(segments.means) + VectorBytes(segments.adjacency);
}

std::uint64_t MemoryBytes(const LabelField& field) {
  std::uint64_t bytes = sizeof(LabelField) + VectorBytes(field.views);
  for (const ViewLabels& view : field.views) bytes += VectorBytes(view.levels) + VectorBytes(view.unchanged);
  return bytes;
}

std::uint64_t MemoryBytes(const RefinedView& view) {
  return sizeof(RefinedView) + VectorBytes(view.planes) + VectorBytes(view.kept) +
         VectorBytes(view.plane_of_pixel.values());
}

std::uint64_t MemoryBytes(const ConfidenceMap& map) { return sizeof(ConfidenceMap) + VectorBytes(map.codes.values()); }

void MemoryCache::Erase(const ArtifactKey& key) {
  const std::scoped_lock lock(mutex_);
  Remove(key);
}

std::uint64_t MemoryCache::total_bytes() const {
  const std::scoped_lock lock(mutex_);
  return total_bytes_;
}

void MemoryCache::Remove(const ArtifactKey& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return;
  total_bytes_ -= found->second->bytes;
  used_.erase(found->second);
  entries_.erase(found);
}

void MemoryCache::Insert(const ArtifactKey& key, Object object, std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  Remove(key);
  if (bytes > max_bytes_) return;
  while (total_bytes_ > max_bytes_ - bytes) {
    const ArtifactKey oldest = used_.front().key;
    Remove(oldest);
  }
  entries_[key] = used_.insert(used_.end(), Entry{key, std::move(object), bytes});
  total_bytes_ += bytes;
}

const MemoryCache::Object* MemoryCache::Use(const ArtifactKey& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return nullptr;
  used_.splice(used_.end(), used_, found->second);
  return &found->second->object;
}

}  // namespace depthfarm
