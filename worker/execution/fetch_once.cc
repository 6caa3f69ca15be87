#include "worker/execution/fetch_once.h"

#include <utility>

#include "common/digest/sha256.h"
#include "common/log/log.h"

namespace depthfarm {

Result<Fetched> FetchOnce(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskInput& input,
                          const std::stop_token& stop) {
  const ArtifactInfo& wanted = input.artifact;
  DEPTHFARM_ASSIGN_OR_RETURN(const KeyLocks::Lock lock, store.fetching().Take(wanted.key, stop));
  const FetchTurn turn = store.TakeFetchTurn(wanted.key, stop);
  if (store.Find(wanted.key) == wanted) {
    if (Result<std::string> stored = store.Get(wanted.key); stored.ok())
      return Fetched{.artifact = *std::move(stored), .fetched_bytes = 0};
  }
  if (stop.stop_requested()) return Cancelled();  // perhaps while it waited
  DEPTHFARM_ASSIGN_OR_RETURN(std::string bytes, fetcher.Fetch(input, stop));
  // A store too full to keep a copy is no reason to fail: the task has what it needs.
  (void)store.PutVerified(wanted, bytes).ok();
  const std::uint64_t size = bytes.size();
  LogDebug("artifact_fetched", {{"key", Hex(wanted.key)}, {"bytes", size}});
  return Fetched{.artifact = std::move(bytes), .fetched_bytes = size};
}

}  // namespace depthfarm
