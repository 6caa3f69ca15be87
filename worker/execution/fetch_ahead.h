#ifndef DEPTHFARM_WORKER_EXECUTION_FETCH_AHEAD_H_
#define DEPTHFARM_WORKER_EXECUTION_FETCH_AHEAD_H_

#include <cstdint>
#include <stop_token>

#include "common/job/task_spec.h"
#include "worker/artifacts/store.h"
#include "worker/execution/artifact_fetcher.h"

namespace depthfarm {

// What was fetched for a task before it runs.
struct FetchedAhead {
  std::uint64_t bytes = 0;
  ArtifactPins pins;  // keep its inputs in the store until then
};

// Fetches an artifact into the store unless it is there (FetchOnce). The bytes that came from another worker; 0 when it
// could not be had.
[[nodiscard]] std::uint64_t FetchIntoStore(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskInput& artifact,
                                           const std::stop_token& stop);

// Fetches the inputs of a task that the store does not hold, into the store. What cannot be had or stored is left to
// the task, which will try again and say why. Returns soon after `stop` is requested, and after the
// artifact under way when `enough` is.
[[nodiscard]] FetchedAhead FetchAhead(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskSpec& spec,
                                      const std::stop_token& stop, const std::stop_token& enough);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_FETCH_AHEAD_H_
