#include "worker/execution/fetch_ahead.h"

#include <string>
#include <utility>
#include <vector>

namespace depthfarm {

FetchedAhead FetchAhead(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskSpec& spec,
                        const std::stop_token& stop) {
  std::vector<ArtifactKey> keys;
  for (const TaskInput& input : spec.inputs) keys.push_back(input.artifact.key);
  FetchedAhead fetched{.bytes = 0, .pins = store.Pin(std::move(keys))};
  if (spec.output_key.has_value() && store.Find(*spec.output_key).has_value()) return fetched;  // nothing will be read
  for (const TaskInput& input : spec.inputs) {
    if (stop.stop_requested()) break;
    if (store.Find(input.artifact.key).has_value()) continue;
    const Result<std::string> bytes = fetcher.Fetch(input, stop);
    if (bytes.ok() && store.Put(input.artifact.key, *bytes).ok()) fetched.bytes += bytes->size();
  }
  return fetched;
}

}  // namespace depthfarm
