#include "coordinator/scheduling/artifact_directory.h"

namespace depthfarm {

ArtifactDirectory::AddResult ArtifactDirectory::Add(WorkerId worker, const ArtifactInfo& artifact) {
  const auto [entry, is_new] = entries_.try_emplace(artifact.key, Entry{artifact, {}});
  if (entry->second.artifact != artifact) return AddResult::kConflict;
  if (entry->second.holders.insert(worker).second) {
    Store& store = stores_[worker];
    store.keys.insert(artifact.key);
    store.bytes += artifact.stored_bytes;
  }
  return AddResult::kAdded;
}

void ArtifactDirectory::RemoveFromStore(WorkerId worker, const ArtifactInfo& artifact) {
  const auto store = stores_.find(worker);
  if (store == stores_.end() || store->second.keys.erase(artifact.key) == 0) return;
  store->second.bytes -= artifact.stored_bytes;
  if (store->second.keys.empty()) stores_.erase(store);
}

bool ArtifactDirectory::Remove(WorkerId worker, const ArtifactKey& key) {
  const auto entry = entries_.find(key);
  if (entry == entries_.end() || entry->second.holders.erase(worker) == 0) return false;
  RemoveFromStore(worker, entry->second.artifact);
  if (!entry->second.holders.empty()) return false;
  entries_.erase(entry);
  return true;
}

std::vector<ArtifactKey> ArtifactDirectory::RemoveWorker(WorkerId worker) {
  std::vector<ArtifactKey> lost;
  for (const ArtifactKey& key : KeysOf(worker)) {
    if (Remove(worker, key)) lost.push_back(key);
  }
  return lost;
}

const ArtifactInfo* ArtifactDirectory::Find(const ArtifactKey& key) const {
  const auto entry = entries_.find(key);
  return entry == entries_.end() ? nullptr : &entry->second.artifact;
}

bool ArtifactDirectory::Holds(WorkerId worker, const ArtifactKey& key) const {
  const auto entry = entries_.find(key);
  return entry != entries_.end() && entry->second.holders.contains(worker);
}

const std::set<WorkerId>& ArtifactDirectory::Holders(const ArtifactKey& key) const {
  static const std::set<WorkerId> kNobody;
  const auto entry = entries_.find(key);
  return entry == entries_.end() ? kNobody : entry->second.holders;
}

std::vector<ArtifactKey> ArtifactDirectory::KeysOf(WorkerId worker) const {
  const auto store = stores_.find(worker);
  if (store == stores_.end()) return {};
  return {store->second.keys.begin(), store->second.keys.end()};
}

std::uint64_t ArtifactDirectory::Count(WorkerId worker) const {
  const auto store = stores_.find(worker);
  return store == stores_.end() ? 0 : store->second.keys.size();
}

std::uint64_t ArtifactDirectory::Bytes(WorkerId worker) const {
  const auto store = stores_.find(worker);
  return store == stores_.end() ? 0 : store->second.bytes;
}

}  // namespace depthfarm
