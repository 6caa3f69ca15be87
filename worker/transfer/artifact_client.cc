#include "worker/transfer/artifact_client.h"

#include <cstdint>
#include <utility>

#include "common/digest/sha256.h"

namespace depthfarm {
namespace {

// What stands around a chunk, and errors, fit into this.
constexpr std::int64_t kMaxFrameAroundChunk = 8192;

}  // namespace

ArtifactClient::ArtifactClient(TransportContext& context, CurveKeys own_keys, const FetchOptions& options)
    : options_(options),
      peers_(context, std::move(own_keys), options.chunk_bytes + kMaxFrameAroundChunk, options.distrust) {}

Result<std::string> ArtifactClient::Fetch(const ArtifactInfo& artifact, std::span<const ArtifactLocation> locations,
                                          const std::stop_token& stop) {
  const std::string name = "artifact " + Hex(artifact.key);
  if (artifact.stored_bytes > options_.max_artifact_bytes) {
    return Unavailable(name + ": " + std::to_string(artifact.stored_bytes) + " bytes, this worker takes at most " +
                       std::to_string(options_.max_artifact_bytes));
  }
  Result<std::string> fetched = depthfarm::Fetch(peers_, options_, artifact, locations, stop).Run();
  if (!fetched.ok() && fetched.status().code() != ErrorCode::kCancelled) return fetched.status().WithContext(name);
  return fetched;
}

}  // namespace depthfarm
