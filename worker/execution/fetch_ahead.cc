#include "worker/execution/fetch_ahead.h"

#include <string>
#include <utility>
#include <vector>

namespace depthfarm {

std::uint64_t FetchIntoStore(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskInput& artifact,
                             const std::stop_token& stop) {
  if (store.Find(artifact.artifact.key).has_value()) return 0;
  const Result<std::string> bytes = fetcher.Fetch(artifact, stop);
  return bytes.ok() && store.PutVerified(artifact.artifact, *bytes).ok() ? bytes->size() : 0;
}

FetchedAhead FetchAhead(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskSpec& spec,
                        const std::stop_token& stop, const std::stop_token& enough) {
  std::vector<ArtifactKey> keys;
  for (const TaskInput& input : spec.inputs) keys.push_back(input.artifact.key);
  FetchedAhead fetched{.bytes = 0, .pins = store.Pin(std::move(keys))};
  if (spec.output_key.has_value() && store.Find(*spec.output_key).has_value()) return fetched;  // nothing will be read
  for (const TaskInput& input : spec.inputs) {
    if (stop.stop_requested() || enough.stop_requested()) return fetched;
    fetched.bytes += FetchIntoStore(store, fetcher, input, stop);
  }
  if (spec.known.has_value() && !stop.stop_requested() && !enough.stop_requested())
    fetched.bytes += FetchIntoStore(store, fetcher, *spec.known, stop);
  return fetched;
}

}  // namespace depthfarm
