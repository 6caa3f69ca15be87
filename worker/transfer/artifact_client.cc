#include "worker/transfer/artifact_client.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/digest/sha256.h"
#include "common/wire/envelope.h"
#include "common/wire/task_wire.h"

namespace depthfarm {
namespace {

constexpr std::size_t kMaxPeers = 64;
constexpr std::chrono::milliseconds kStopCheck{50};

std::string PeerName(const ArtifactLocation& location) { return location.endpoint + " " + location.public_key; }

}  // namespace

ArtifactClient::ArtifactClient(TransportContext& context, CurveKeys own_keys, const FetchOptions& options)
    : context_(context), own_keys_(std::move(own_keys)), options_(options) {}

Result<std::string> ArtifactClient::Fetch(const ArtifactInfo& artifact, std::span<const ArtifactLocation> locations,
                                          const std::stop_token& stop) {
  const std::string name = "artifact " + Hex(artifact.key);
  if (artifact.stored_bytes > options_.max_artifact_bytes) {
    return Unavailable(name + ": " + std::to_string(artifact.stored_bytes) + " bytes, this worker takes at most " +
                       std::to_string(options_.max_artifact_bytes));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(Assembly assembly, Assembly::Create(artifact.stored_bytes, options_.chunk_bytes));
  Status failure(ErrorCode::kUnavailable, locations.empty() ? "held by no worker" : "");
  for (const ArtifactLocation& location : locations) {
    bool mixed = !assembly.empty();
    while (true) {
      Status fetched = FetchFrom(artifact, location, assembly, stop);
      if (fetched.code() == ErrorCode::kCancelled) return fetched;
      if (fetched.ok()) {
        if (Sha256(assembly.bytes()) == artifact.content_digest) return std::move(assembly).Take();
        fetched = Corrupt("not the artifact of that digest");
        assembly.Reset();
        // Pieces of an earlier location may be the wrong ones: all of it from this one alone, once.
        if (std::exchange(mixed, false)) continue;
      }
      const std::string told = failure.message().empty() ? "" : failure.message() + "; ";
      failure = Status(fetched.code(), told + location.endpoint + ": " + fetched.message());
      break;
    }
  }
  const ErrorCode code = failure.code() == ErrorCode::kCorrupt ? ErrorCode::kCorrupt : ErrorCode::kUnavailable;
  return Status(code, failure.message()).WithContext(name);
}

Status ArtifactClient::FetchFrom(const ArtifactInfo& artifact, const ArtifactLocation& location, Assembly& assembly,
                                 const std::stop_token& stop) {
  if (assembly.complete()) return {};
  if (Distrusted(location)) return Unavailable("was silent a moment ago");
  DEPTHFARM_ASSIGN_OR_RETURN(ClientChannel* const channel, Connect(location));
  assembly.ForgetAsks();
  std::map<std::uint64_t, std::size_t> requests;
  Clock::time_point heard = Clock::now();
  while (!assembly.complete()) {
    if (stop.stop_requested()) return Cancelled();
    DEPTHFARM_RETURN_IF_ERROR(Ask(artifact, *channel, assembly, requests));
    DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<std::string> message, channel->Receive(kStopCheck));
    if (!message.has_value()) {
      if (Clock::now() - heard < options_.silence) continue;
      peers_.erase(PeerName(location));
      distrusted_[PeerName(location)] = Clock::now() + options_.distrust;
      return Unavailable("silent for " + std::to_string(options_.silence.count()) + " ms");
    }
    DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope answer, ParseEnvelope(*message));
    const auto request = requests.find(answer.request_id());
    if (request == requests.end()) continue;  // a late answer to an earlier fetch
    DEPTHFARM_RETURN_IF_ERROR(Take(artifact, answer, request->second, assembly));
    requests.erase(request);
    heard = Clock::now();
  }
  return {};
}

Status ArtifactClient::Ask(const ArtifactInfo& artifact, ClientChannel& channel, Assembly& assembly,
                           std::map<std::uint64_t, std::size_t>& requests) {
  while (requests.size() < static_cast<std::size_t>(options_.chunks_in_flight)) {
    const std::optional<std::size_t> index = assembly.AskNext();
    if (!index.has_value()) return {};
    const Assembly::Piece piece = assembly.PieceAt(*index);
    v1::Envelope request;
    request.set_request_id(++last_request_);
    v1::GetChunk& get = *request.mutable_get_chunk();
    get.set_key(DigestBytes(artifact.key));
    get.set_offset(piece.offset);
    get.set_max_bytes(piece.bytes);
    DEPTHFARM_RETURN_IF_ERROR(channel.Send(SerializeEnvelope(std::move(request))));
    requests[last_request_] = *index;
  }
  return {};
}

Status ArtifactClient::Take(const ArtifactInfo& artifact, const v1::Envelope& answer, std::size_t piece,
                            Assembly& assembly) {
  if (answer.has_error()) return FromProto(answer.error());
  if (!answer.has_chunk()) return Corrupt("answered get_chunk with " + BodyName(answer));
  const v1::Chunk& chunk = answer.chunk();
  if (chunk.has_error() && chunk.error().code() != v1::CODE_OK) return FromProto(chunk.error());
  const Assembly::Piece expected = assembly.PieceAt(piece);
  if (chunk.key() != DigestBytes(artifact.key) || chunk.offset() != expected.offset ||
      chunk.total_bytes() != artifact.stored_bytes || chunk.data().size() != expected.bytes) {
    return Corrupt("sent " + std::to_string(chunk.data().size()) + " bytes at " + std::to_string(chunk.offset()) +
                   " of " + std::to_string(chunk.total_bytes()) + ", expected " + std::to_string(expected.bytes) +
                   " at " + std::to_string(expected.offset) + " of " + std::to_string(artifact.stored_bytes));
  }
  assembly.Fill(piece, chunk.data());
  return {};
}

Result<ClientChannel*> ArtifactClient::Connect(const ArtifactLocation& location) {
  const std::string name = PeerName(location);
  const auto known = peers_.find(name);
  if (known != peers_.end()) {
    known->second.last_use = ++uses_;
    return known->second.channel.get();
  }
  if (peers_.size() >= kMaxPeers) {
    peers_.erase(std::ranges::min_element(peers_, {}, [](const auto& peer) { return peer.second.last_use; }));
  }
  ClientOptions options;
  options.curve_server_public_key = location.public_key;
  options.linger = std::chrono::milliseconds(0);
  // An answer is one chunk and a few dozen bytes around it.
  options.max_message_bytes = 2 * static_cast<std::int64_t>(options_.chunk_bytes) + 4096;
  if (!location.public_key.empty()) {
    if (own_keys_.public_key.empty()) return Unavailable("needs a key and this worker has none");
    options.curve_own = own_keys_;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<ClientChannel> channel,
                             ClientChannel::Connect(context_, location.endpoint, options));
  Peer& peer = peers_[name];
  peer = {std::move(channel), ++uses_};
  return peer.channel.get();
}

bool ArtifactClient::Distrusted(const ArtifactLocation& location) {
  const auto found = distrusted_.find(PeerName(location));
  if (found == distrusted_.end()) return false;
  if (Clock::now() < found->second) return true;
  distrusted_.erase(found);
  return false;
}

}  // namespace depthfarm
