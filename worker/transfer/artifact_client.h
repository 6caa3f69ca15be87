#ifndef DEPTHFARM_WORKER_TRANSFER_ARTIFACT_CLIENT_H_
#define DEPTHFARM_WORKER_TRANSFER_ARTIFACT_CLIENT_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <stop_token>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/transport/keys.h"
#include "depthfarm/v1/farm.pb.h"
#include "worker/transfer/assembly.h"

namespace depthfarm {

struct FetchOptions {
  int chunks_in_flight = 4;                  // 4 MiB of one location's answers: fills 1 Gbit/s at 30 ms
  std::uint32_t chunk_bytes = 1 << 20;       // at most kMaxChunkBytes
  std::chrono::milliseconds silence{4000};   // a location that sends nothing for this long has failed
  std::chrono::milliseconds distrust{4000};  // a silent location is not tried again for this long
  std::uint64_t max_artifact_bytes = std::uint64_t{1} << 36;
};

// Fetches artifacts from the artifact servers of other workers. Keeps its connections. Not thread-safe: the computing
// thread owns it.
class ArtifactClient {
 public:
  // `own_keys` without a public key: only locations without one can be used (ipc, or loopback by explicit wish).
  ArtifactClient(TransportContext& context, CurveKeys own_keys, const FetchOptions& options);

  // The artifact's bytes, checked against size and digest. Locations are tried in order; what one has sent before it
  // failed is kept. Errors: kUnavailable: no location could serve it (the message has each one's reason); kCorrupt:
  // what they served is something else; kCancelled: soon (100 ms) after `stop` is requested.
  [[nodiscard]] Result<std::string> Fetch(const ArtifactInfo& artifact, std::span<const ArtifactLocation> locations,
                                          const std::stop_token& stop);

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::unique_ptr<ClientChannel> channel;
    std::uint64_t last_use = 0;
  };

  // Completes the assembly from one location, or says why not.
  [[nodiscard]] Status FetchFrom(const ArtifactInfo& artifact, const ArtifactLocation& location, Assembly& assembly,
                                 const std::stop_token& stop);
  [[nodiscard]] Result<ClientChannel*> Connect(const ArtifactLocation& location);
  [[nodiscard]] bool Distrusted(const ArtifactLocation& location);
  // Asks for pieces up to the credit; requests maps request ids to pieces.
  [[nodiscard]] Status Ask(const ArtifactInfo& artifact, ClientChannel& channel, Assembly& assembly,
                           std::map<std::uint64_t, std::size_t>& requests);
  [[nodiscard]] static Status Take(const ArtifactInfo& artifact, const v1::Envelope& answer, std::size_t piece,
                                   Assembly& assembly);

  TransportContext& context_;
  const CurveKeys own_keys_;
  const FetchOptions options_;
  std::map<std::string, Peer> peers_;                    // by endpoint and key
  std::map<std::string, Clock::time_point> distrusted_;  // same; until when
  std::uint64_t last_request_ = 0;
  std::uint64_t uses_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_ARTIFACT_CLIENT_H_
