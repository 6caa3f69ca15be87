#ifndef DEPTHFARM_WORKER_TRANSFER_ARTIFACT_CLIENT_H_
#define DEPTHFARM_WORKER_TRANSFER_ARTIFACT_CLIENT_H_

#include <span>
#include <stop_token>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/transport/context.h"
#include "common/transport/keys.h"
#include "worker/transfer/fetch.h"
#include "worker/transfer/peers.h"

namespace depthfarm {

// Fetches artifacts from the artifact servers of other workers. Keeps its connections. Not thread-safe: each thread
// that fetches has its own.
class ArtifactClient {
 public:
  // `own_keys` without a public key: only locations without one can be used (ipc, or loopback by explicit wish).
  ArtifactClient(TransportContext& context, CurveKeys own_keys, const FetchOptions& options);

  // The artifact's bytes, checked against size and digest. Large ones come from several locations at once, the first
  // ones before the others; what one has sent before it failed is kept. When the pieces of several make something else,
  // each location is tried alone. Takes FetchOptions::chunks_in_flight chunks, 12 MiB, beside the artifact. Errors:
  // kUnavailable: no location could serve it (the message has each one's reason); kCorrupt: the same, and one at least
  // served something else, or an empty artifact cannot have that digest; kCancelled: soon (100 ms) after `stop` is
  // requested.
  [[nodiscard]] Result<std::string> Fetch(const ArtifactInfo& artifact, std::span<const ArtifactLocation> locations,
                                          const std::stop_token& stop);

 private:
  const FetchOptions options_;
  Peers peers_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_ARTIFACT_CLIENT_H_
