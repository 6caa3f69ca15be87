#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_ANALYSIS_MEMO_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_ANALYSIS_MEMO_H_

#include <cstddef>
#include <deque>
#include <map>
#include <optional>

#include "common/job/task.h"

namespace depthfarm {

// Which artifact an Analyse task of such a request made last (ArtifactKeys::AnalysisRequest): its name holds the digest
// of the picture, which only who reads the file knows. A hint: the file may have changed since, so the worker that
// reads it has the last word. Bounded: the oldest are forgotten. About 150 bytes
// each: 150 MB when it is full.
class AnalysisMemo {
 public:
  explicit AnalysisMemo(std::size_t most = std::size_t{1} << 20) : most_(most) {}

  void Remember(const ArtifactKey& request, const ArtifactKey& made);
  [[nodiscard]] std::optional<ArtifactKey> Find(const ArtifactKey& request) const;

 private:
  const std::size_t most_;
  std::map<ArtifactKey, ArtifactKey> made_;
  std::deque<ArtifactKey> order_;  // of the requests, oldest first
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_ANALYSIS_MEMO_H_
