#ifndef DEPTHFARM_WORKER_EXECUTION_FETCH_ONCE_H_
#define DEPTHFARM_WORKER_EXECUTION_FETCH_ONCE_H_

#include <cstdint>
#include <stop_token>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/store.h"
#include "worker/execution/artifact_fetcher.h"

namespace depthfarm {

struct Fetched {
  std::string artifact;
  std::uint64_t fetched_bytes = 0;  // that came from another worker: all, or none when the store had it
};

// The bytes of an input that the store did not hold a moment ago. Of the threads that share a store, and the workers
// that share its folder, one fetches an artifact and stores it; those that want it meanwhile wait, and read what was
// stored. Errors: as ArtifactFetcher::Fetch; kCancelled when `stop` is requested while it waits: at once if for a
// thread of this store, soon if for another worker.
[[nodiscard]] Result<Fetched> FetchOnce(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskInput& input,
                                        const std::stop_token& stop);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_FETCH_ONCE_H_
