#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_ARTIFACT_DIRECTORY_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_ARTIFACT_DIRECTORY_H_

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "common/job/task_spec.h"

namespace depthfarm {

// Which worker holds which artifact. An artifact without holders is forgotten.
class ArtifactDirectory {
 public:
  enum class AddResult {
    kAdded,     // or known already
    kConflict,  // the same key with another content: not added, the first one stays
  };
  AddResult Add(WorkerId worker, const ArtifactInfo& artifact);
  // True when that was the last holder.
  bool Remove(WorkerId worker, const ArtifactKey& key);
  // The keys that nobody holds any more.
  std::vector<ArtifactKey> RemoveWorker(WorkerId worker);

  // Null when nobody holds it.
  [[nodiscard]] const ArtifactInfo* Find(const ArtifactKey& key) const;
  [[nodiscard]] bool Holds(WorkerId worker, const ArtifactKey& key) const;
  [[nodiscard]] std::vector<ArtifactKey> KeysOf(WorkerId worker) const;
  [[nodiscard]] const std::set<WorkerId>& Holders(const ArtifactKey& key) const;

  [[nodiscard]] std::uint64_t Count(WorkerId worker) const;
  [[nodiscard]] std::uint64_t Bytes(WorkerId worker) const;
  [[nodiscard]] bool empty() const { return entries_.empty(); }

 private:
  struct Entry {
    ArtifactInfo artifact;
    std::set<WorkerId> holders;
  };
  struct Store {
    std::set<ArtifactKey> keys;
    std::uint64_t bytes = 0;
  };
  void RemoveFromStore(WorkerId worker, const ArtifactInfo& artifact);

  std::map<ArtifactKey, Entry> entries_;
  std::map<WorkerId, Store> stores_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_ARTIFACT_DIRECTORY_H_
