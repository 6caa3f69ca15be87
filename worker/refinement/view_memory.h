#ifndef DEPTHFARM_WORKER_REFINEMENT_VIEW_MEMORY_H_
#define DEPTHFARM_WORKER_REFINEMENT_VIEW_MEMORY_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "worker/refinement/picture_samples.h"
#include "worker/refinement/plane_field.h"
#include "worker/segmentation/analysis.h"

namespace depthfarm {

// What is made of each of some sources, kept until others are asked for. A source is an object, not its value. Keeps no
// source alive. Not thread-safe.
template <typename Source, typename Made>
class LastMade {
 public:
  // Of each source (none null), in their order. What was made of a source that is not among them is dropped before
  // `make` is called for those that are new.
  template <typename Make>
  [[nodiscard]] std::vector<std::shared_ptr<const Made>> Of(std::span<const std::shared_ptr<const Source>> sources,
                                                            const Make& make) {
    std::vector<Entry> entries;
    for (const auto& source : sources) entries.push_back({source, MadeOf(source)});
    entries_ = std::move(entries);
    std::vector<std::shared_ptr<const Made>> result;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (entries_[i].made == nullptr) entries_[i].made = std::make_shared<const Made>(make(*sources[i]));
      result.push_back(entries_[i].made);
    }
    return result;
  }
  void Clear() { entries_.clear(); }

 private:
  struct Entry {
    std::weak_ptr<const Source> source;
    std::shared_ptr<const Made> made;
  };
  [[nodiscard]] std::shared_ptr<const Made> MadeOf(const std::shared_ptr<const Source>& source) const {
    for (const Entry& entry : entries_)
      if (!entry.source.owner_before(source) && !source.owner_before(entry.source)) return entry.made;
    return nullptr;
  }

  std::vector<Entry> entries_;
};

// A picture after Blurred and its segments without texture.
struct SmoothedPicture {
  FineImage colours;
  std::vector<std::uint8_t> plain;  // PlainSegments
};

// What one task after the other makes of the same views when all views of a round are refined: each is compared with by
// up to four. Holds what the last task has read and no more; only saves time. Not thread-safe.
class ViewMemory {
 public:
  using Maps = std::vector<std::shared_ptr<const InverseDepthMap>>;
  using Smoothed = std::vector<std::shared_ptr<const SmoothedPicture>>;

  // RefinedView::Map of each.
  [[nodiscard]] Maps MapsOf(std::span<const std::shared_ptr<const RefinedView>> views, int threads = 1);
  [[nodiscard]] Smoothed SmoothedOf(std::span<const std::shared_ptr<const ViewAnalysis>> analyses, int threads = 1);
  void ForgetSmoothed() { smoothed_.Clear(); }
  // For tasks of another kind, which need the room.
  void Clear();

 private:
  LastMade<RefinedView, InverseDepthMap> maps_;
  LastMade<ViewAnalysis, SmoothedPicture> smoothed_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_VIEW_MEMORY_H_
