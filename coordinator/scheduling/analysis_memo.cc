#include "coordinator/scheduling/analysis_memo.h"

namespace depthfarm {

void AnalysisMemo::Remember(const ArtifactKey& request, const ArtifactKey& made) {
  if (!made_.insert_or_assign(request, made).second) return;
  order_.push_back(request);
  if (order_.size() <= most_) return;
  made_.erase(order_.front());
  order_.pop_front();
}

std::optional<ArtifactKey> AnalysisMemo::Find(const ArtifactKey& request) const {
  const auto found = made_.find(request);
  return found == made_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace depthfarm
