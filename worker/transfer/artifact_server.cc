#include "worker/transfer/artifact_server.h"

#include <chrono>
#include <optional>
#include <utility>

#include "common/log/log.h"
#include "common/wire/task_wire.h"

namespace depthfarm {
namespace {

constexpr std::int64_t kMaxRequestBytes = 4096;
constexpr std::chrono::milliseconds kWait{1000};
// A peer has up to 8 requests under way, and may have given up as many: more is somebody who does not read.
constexpr int kMaxQueuedAnswers = 64;

Result<ArtifactChunk> ReadRequested(ChunkSource& source, const v1::GetChunk& request) {
  DEPTHFARM_ASSIGN_OR_RETURN(const ArtifactKey key, DigestFromBytes("get_chunk.key", request.key()));
  if (request.max_bytes() == 0 || request.max_bytes() > kMaxChunkBytes) {
    return InvalidArgument("get_chunk.max_bytes is " + std::to_string(request.max_bytes()) + ", expected 1 to " +
                           std::to_string(kMaxChunkBytes));
  }
  return source.ReadChunk(key, request.offset(), request.max_bytes());
}

}  // namespace

PeerAnswer AnswerPeer(ChunkSource& source, const v1::Envelope& request) {
  PeerAnswer peer_answer;
  v1::Envelope& answer = peer_answer.envelope;
  answer.set_request_id(request.request_id());
  if (!request.has_get_chunk()) {
    *answer.mutable_error() =
        ToProto(InvalidArgument("an artifact server answers get_chunk, not " + BodyName(request)));
    return peer_answer;
  }
  v1::Chunk& chunk = *answer.mutable_chunk();
  chunk.set_key(request.get_chunk().key().substr(0, std::tuple_size_v<ArtifactKey>));
  chunk.set_offset(request.get_chunk().offset());
  Result<ArtifactChunk> read = ReadRequested(source, request.get_chunk());
  if (read.ok()) {
    chunk.set_total_bytes(read->total_bytes);
    peer_answer.attachment = std::move(read->data);
  } else {
    *chunk.mutable_error() = ToProto(read.status());
  }
  return peer_answer;
}

Result<std::unique_ptr<ArtifactServer>> ArtifactServer::Start(TransportContext& context, ChunkSource& source,
                                                              const std::string& endpoint,
                                                              const std::string& curve_secret_key) {
  const ServerOptions options{.curve_secret_key = curve_secret_key,
                              .max_message_bytes = kMaxRequestBytes,
                              .max_queued_messages = kMaxQueuedAnswers};
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<ServerChannel> channel, ServerChannel::Bind(context, endpoint, options));
  return std::unique_ptr<ArtifactServer>(new ArtifactServer(source, std::move(channel)));
}

ArtifactServer::ArtifactServer(ChunkSource& source, std::unique_ptr<ServerChannel> channel)
    : source_(source), channel_(std::move(channel)), endpoint_(channel_->endpoint()), thread_([this] { Serve(); }) {}

ArtifactServer::~ArtifactServer() {
  stopping_ = true;
  poller_.Wake();
  thread_.join();
}

void ArtifactServer::Serve() {
  const Channel* const channels[] = {channel_.get()};
  while (!stopping_) {
    const Status waited = poller_.Wait(channels, kWait);
    if (!waited.ok()) {
      LogError("artifact_server_failed", {{"reason", waited.message()}});
      return;
    }
    AnswerWaiting();
  }
}

void ArtifactServer::AnswerWaiting() {
  while (!stopping_) {
    Result<std::optional<PeerMessage>> message = channel_->Receive();
    if (!message.ok()) {
      LogWarning("artifact_server_receive_failed", {{"reason", message.status().message()}});
      return;
    }
    if (!message->has_value()) return;
    const Result<v1::Envelope> request = ParseEnvelope((*message)->payload);
    PeerAnswer answer;
    if (request.ok()) {
      answer = AnswerPeer(source_, *request);
    } else {
      *answer.envelope.mutable_error() = ToProto(request.status());
    }
    const std::string envelope = SerializeEnvelope(std::move(answer.envelope));
    const Status sent = answer.attachment.empty()
                            ? channel_->Send((*message)->peer, envelope)
                            : channel_->Send((*message)->peer, envelope, std::move(answer.attachment));
    if (!sent.ok()) LogDebug("artifact_answer_lost", {{"reason", sent.message()}});
  }
}

}  // namespace depthfarm
