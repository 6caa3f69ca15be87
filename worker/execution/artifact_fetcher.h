#ifndef DEPTHFARM_WORKER_EXECUTION_ARTIFACT_FETCHER_H_
#define DEPTHFARM_WORKER_EXECUTION_ARTIFACT_FETCHER_H_

#include <stop_token>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// Where a task gets the inputs that this worker does not hold.
class ArtifactFetcher {
 public:
  virtual ~ArtifactFetcher() = default;
  // The artifact's bytes, checked against its size and digest. Errors: kUnavailable or kCorrupt: no location could
  // serve it; kCancelled soon after `stop` is requested.
  [[nodiscard]] virtual Result<std::string> Fetch(const TaskInput& input, const std::stop_token& stop) = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_ARTIFACT_FETCHER_H_
