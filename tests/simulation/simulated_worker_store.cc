#include <algorithm>
#include <utility>

#include "tests/simulation/simulated_worker.h"
#include "tests/simulation/task_model.h"

// What a simulated worker keeps and serves.

namespace depthfarm::simulation {

std::optional<ContentDigest> SimulatedWorker::Serve(const ArtifactKey& key) const {
  const auto stored = store_.find(key);
  if (!alive() || hung() || stored == store_.end()) return std::nullopt;
  return stored->second.content;
}

const SimulatedWorker::Stored* SimulatedWorker::Read(const ArtifactKey& key) {
  const auto stored = store_.find(key);
  if (stored == store_.end()) return nullptr;
  if (stored->second.content != stored->second.info.content_digest) {
    store_.erase(stored);
    dropped_.push_back(key);
    return nullptr;
  }
  stored->second.used = ++used_;
  return &stored->second;
}

void SimulatedWorker::Store(const ArtifactInfo& artifact) {
  store_[artifact.key] = {artifact, artifact.content_digest, false, false, ++used_};
  std::erase(dropped_, artifact.key);
  Evict();
}

void SimulatedWorker::Evict() {
  if (store_.size() <= shape_.store_bound) return;
  std::set<ArtifactKey> pinned;
  for (const Running& task : tasks_) {
    for (const TaskInput& input : task.spec.inputs) pinned.insert(input.artifact.key);
    if (task.spec.output_key) pinned.insert(*task.spec.output_key);
    if (task.spec.id.kind == TaskKind::kAnalyse) pinned.insert(AnalysisKeyOf(task.spec));
  }
  std::vector<std::pair<std::pair<int, std::uint64_t>, ArtifactKey>> order;
  for (const auto& [key, stored] : store_) {
    const int turn = stored.released ? 0 : stored.kept ? 2 : 1;
    if (!pinned.contains(key)) order.push_back({{turn, stored.used}, key});
  }
  std::ranges::sort(order);
  for (const auto& [turn, key] : order) {
    if (store_.size() <= shape_.store_bound) return;
    store_.erase(key);
    dropped_.push_back(key);
  }
}

void SimulatedWorker::DamageArtifacts(int percent) {
  for (auto& [key, stored] : store_) {
    if (around_.random.Chance(percent)) stored.content = {};
  }
}

}  // namespace depthfarm::simulation
