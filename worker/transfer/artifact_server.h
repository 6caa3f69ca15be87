#ifndef DEPTHFARM_WORKER_TRANSFER_ARTIFACT_SERVER_H_
#define DEPTHFARM_WORKER_TRANSFER_ARTIFACT_SERVER_H_

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "common/base/shared_bytes.h"
#include "common/base/status.h"
#include "common/transport/context.h"
#include "common/transport/poller.h"
#include "common/transport/server_channel.h"
#include "common/wire/envelope.h"
#include "worker/artifacts/chunk_source.h"

namespace depthfarm {

// The largest piece of an artifact in one message.
inline constexpr std::uint32_t kMaxChunkBytes = 1 << 20;

// A message and its second frame, if that is not empty.
struct PeerAnswer {
  v1::Envelope envelope;
  SharedBytes attachment;
};

// What an artifact server answers. GetChunk: a Chunk and its bytes as attachment, or a Chunk whose error says what is
// wrong (kUnavailable: not here; kInvalidArgument: no key, offset past the end, more than kMaxChunkBytes or
// nothing asked for). Anything else: Error.
[[nodiscard]] PeerAnswer AnswerPeer(ChunkSource& source, const v1::Envelope& request);

// Serves artifacts to other workers from a thread of its own, until it is destroyed. Peers that do not
// read their answers lose them: nothing waits for anybody, and at most 64 chunks wait for one peer.
class ArtifactServer {
 public:
  // `curve_secret_key` empty: no CURVE. Errors as ServerChannel::Bind. Context and source must outlive the server.
  [[nodiscard]] static Result<std::unique_ptr<ArtifactServer>> Start(TransportContext& context, ChunkSource& source,
                                                                     const std::string& endpoint,
                                                                     const std::string& curve_secret_key);
  ~ArtifactServer();
  ArtifactServer(const ArtifactServer&) = delete;
  ArtifactServer& operator=(const ArtifactServer&) = delete;

  // Where it is bound in fact.
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  ArtifactServer(ChunkSource& source, std::unique_ptr<ServerChannel> channel);
  void Serve();
  void AnswerWaiting();

  ChunkSource& source_;
  std::unique_ptr<ServerChannel> channel_;
  const std::string endpoint_;
  Poller poller_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_ARTIFACT_SERVER_H_
