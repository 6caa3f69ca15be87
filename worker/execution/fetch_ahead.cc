#include "worker/execution/fetch_ahead.h"

#include <utility>
#include <vector>

#include "worker/execution/fetch_once.h"
#include "worker/execution/uploaded_files.h"

namespace depthfarm {

std::uint64_t FetchIntoStore(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskInput& artifact,
                             const std::stop_token& stop) {
  if (store.Find(artifact.artifact.key).has_value()) return 0;
  const Result<Fetched> fetched = FetchOnce(store, fetcher, artifact, stop);
  return fetched.ok() ? fetched->fetched_bytes : 0;
}

FetchedAhead FetchAhead(ArtifactStore& store, ArtifactFetcher& fetcher, const TaskSpec& spec,
                        const std::stop_token& stop, const std::stop_token& enough) {
  std::vector<ArtifactKey> keys;
  for (const TaskInput& input : spec.inputs) keys.push_back(input.artifact.key);
  const std::vector<TaskInput> uploads = UploadsOf(spec);
  for (const TaskInput& upload : uploads) keys.push_back(upload.artifact.key);
  FetchedAhead fetched{.bytes = 0, .pins = store.Pin(std::move(keys))};
  if (spec.output_key.has_value() && store.Find(*spec.output_key).has_value()) return fetched;  // nothing will be read
  for (const TaskInput& input : spec.inputs) {
    if (stop.stop_requested() || enough.stop_requested()) return fetched;
    fetched.bytes += FetchIntoStore(store, fetcher, input, stop);
  }
  // What such a task made before is found again by the digests of these files, without the files.
  for (const TaskInput& upload : spec.known ? std::vector<TaskInput>() : uploads) {
    if (stop.stop_requested() || enough.stop_requested()) return fetched;
    fetched.bytes += FetchIntoStore(store, fetcher, upload, stop);
  }
  if (spec.known.has_value() && !stop.stop_requested() && !enough.stop_requested())
    fetched.bytes += FetchIntoStore(store, fetcher, *spec.known, stop);
  return fetched;
}

}  // namespace depthfarm
