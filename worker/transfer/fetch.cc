#include "worker/transfer/fetch.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/wire/envelope.h"
#include "common/wire/task_wire.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kStopCheck{50};

}  // namespace

Fetch::Fetch(Peers& peers, const FetchOptions& options, const ArtifactInfo& artifact,
             std::span<const ArtifactLocation> locations, std::stop_token stop)
    : peers_(peers), options_(options), artifact_(artifact), stop_(std::move(stop)) {
  for (const ArtifactLocation& location : locations) {
    const auto same = [&](const Candidate& candidate) { return candidate.location == location; };
    if (std::ranges::none_of(candidates_, same)) candidates_.push_back({location, peers_.Postponed(location)});
  }
  std::stable_partition(candidates_.begin(), candidates_.end(),
                        [](const Candidate& candidate) { return !candidate.last_chance; });
  failure_ = Status(ErrorCode::kUnavailable, locations.empty() ? "held by no worker" : "");
}

Fetch::~Fetch() {
  // What is still on the way would fill memory: it goes with its connection.
  for (const Source& source : sources_) {
    if (!source.pending.empty()) peers_.Forget(source.candidate.location);
  }
}

Result<std::string> Fetch::Run() {
  DEPTHFARM_ASSIGN_OR_RETURN(
      Assembly assembly, Assembly::Create(artifact_.stored_bytes, options_.chunk_bytes, options_.digest_thread_bytes));
  // Another location is worth its connection when it has its credit to send.
  const std::size_t worth = assembly.num_pieces() / static_cast<std::size_t>(options_.chunks_of_location);
  max_sources_ = std::clamp(worth, std::size_t{1}, static_cast<std::size_t>(options_.max_locations));
  while (true) {
    if (candidates_.empty() && sources_.empty()) return failure_;
    DEPTHFARM_ASSIGN_OR_RETURN(const ContentDigest digest, Complete(assembly));
    if (digest == artifact_.content_digest) return std::move(assembly).Take();
    // Nobody was asked, and nobody could send something else.
    if (artifact_.stored_bytes == 0) return Corrupt("is empty, and its digest is not that of nothing");
    StartAnew(assembly);
  }
}

Result<ContentDigest> Fetch::Complete(Assembly& assembly) {
  while (true) {
    if (stop_.stop_requested()) return Cancelled();
    if (assembly.complete()) {
      if (const std::optional<ContentDigest> digest = assembly.Digest(kStopCheck)) return *digest;
      continue;
    }
    AdmitSources(assembly);
    if (sources_.empty()) return failure_;
    Ask(assembly);
    DEPTHFARM_RETURN_IF_ERROR(Wait());
    for (Source& source : sources_) {
      if (source.failure.ok()) source.failure = TakeAnswers(assembly, source);
    }
    Sweep(assembly);
  }
}

void Fetch::AdmitSources(Assembly& assembly) {
  const std::size_t most = alone_ ? 1 : max_sources_;
  while (sources_.size() < most && !candidates_.empty() && assembly.HasUnasked()) {
    const Candidate candidate = candidates_.front();
    // Else it would be given what it was too late for.
    if (candidate.last_chance && !sources_.empty()) return;
    candidates_.pop_front();
    Result<std::shared_ptr<ClientChannel>> channel = peers_.Connect(candidate.location);
    if (!channel.ok()) {
      Blame(candidate.location, channel.status());
      continue;
    }
    if (alone_) {
      assembly.Reset();
      contributors_.clear();
    }
    sources_.push_back({candidate, std::move(*channel), {}, Clock::now(), {}});
  }
}

void Fetch::Ask(Assembly& assembly) {
  const auto of_all = static_cast<std::size_t>(options_.chunks_in_flight);
  const auto of_one =
      std::clamp(of_all / sources_.size(), std::size_t{1}, static_cast<std::size_t>(options_.chunks_of_location));
  while (in_flight_ < of_all && assembly.HasUnasked()) {
    // A source that failed looks as busy as can be.
    const auto load = [&](const Source& source) { return source.failure.ok() ? source.pending.size() : of_one; };
    const auto idlest = std::ranges::min_element(sources_, {}, load);
    if (load(*idlest) >= of_one) return;
    idlest->failure = AskOne(assembly, *idlest);
  }
}

Status Fetch::AskOne(Assembly& assembly, Source& source) {
  const std::size_t index = *assembly.AskNext();
  const Assembly::Piece piece = assembly.PieceAt(index);
  const std::uint64_t id = peers_.NextRequest();
  if (source.pending.empty()) source.heard = Clock::now();
  source.pending[id] = index;
  ++in_flight_;
  v1::Envelope request;
  request.set_request_id(id);
  v1::GetChunk& get = *request.mutable_get_chunk();
  get.set_key(DigestBytes(artifact_.key));
  get.set_offset(piece.offset);
  get.set_max_bytes(piece.bytes);
  return source.channel->Send(SerializeEnvelope(std::move(request)));
}

Status Fetch::Wait() {
  std::vector<const Channel*> channels;
  channels.reserve(sources_.size());
  for (const Source& source : sources_) channels.push_back(source.channel.get());
  return poller_.Wait(channels, kStopCheck);
}

Status Fetch::TakeAnswers(Assembly& assembly, Source& source) {
  // As many as may be under way, so that a peer that sends without end keeps nobody from the others.
  for (int i = 0; i < options_.chunks_of_location; ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<ReceivedMessage> message,
                               source.channel->ReceiveAttached(std::chrono::milliseconds(0)));
    if (!message.has_value()) return {};
    DEPTHFARM_RETURN_IF_ERROR(Take(assembly, source, *message));
    // Before the digest of what is here, which can go on beside the transfer.
    Ask(assembly);
    assembly.HashNext();
  }
  return {};
}

Status Fetch::Take(Assembly& assembly, Source& source, const ReceivedMessage& message) {
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope answer, ParseEnvelope(message.payload()));
  const auto request = source.pending.find(answer.request_id());
  if (request == source.pending.end()) return {};  // nothing that was asked
  if (answer.has_error()) return FromProto(answer.error());
  if (!answer.has_chunk()) return Corrupt("answered get_chunk with " + BodyName(answer));
  const v1::Chunk& chunk = answer.chunk();
  if (chunk.has_error() && chunk.error().code() != v1::CODE_OK) return FromProto(chunk.error());
  const Assembly::Piece expected = assembly.PieceAt(request->second);
  const std::string_view data = message.attachment();
  if (chunk.key() != DigestBytes(artifact_.key) || chunk.offset() != expected.offset ||
      chunk.total_bytes() != artifact_.stored_bytes || data.size() != expected.bytes) {
    return Corrupt("sent " + std::to_string(data.size()) + " bytes at " + std::to_string(chunk.offset()) + " of " +
                   std::to_string(chunk.total_bytes()) + ", expected " + std::to_string(expected.bytes) + " at " +
                   std::to_string(expected.offset) + " of " + std::to_string(artifact_.stored_bytes));
  }
  assembly.Fill(request->second, data);
  source.pending.erase(request);
  --in_flight_;
  source.heard = Clock::now();
  if (std::ranges::find(contributors_, source.candidate.location) == contributors_.end()) {
    contributors_.push_back(source.candidate.location);
  }
  return {};
}

void Fetch::Sweep(Assembly& assembly) {
  const Clock::time_point now = Clock::now();
  for (auto source = sources_.begin(); source != sources_.end();) {
    const ArtifactLocation& location = source->candidate.location;
    const auto quiet = source->pending.empty() ? Clock::duration::zero() : now - source->heard;
    const bool others = sources_.size() > 1 || !candidates_.empty();
    if (!source->failure.ok()) {
      peers_.Forget(location);
      Blame(location, source->failure);
    } else if (quiet >= options_.silence) {
      peers_.Distrust(location);
      Blame(location, Unavailable("silent for " + std::to_string(options_.silence.count()) + " ms"));
    } else if (quiet >= options_.patience && others && !source->candidate.last_chance) {
      peers_.Postpone(location);
      candidates_.push_back({location, true});
    } else {
      ++source;
      continue;
    }
    TakeBack(assembly, *source);
    source = sources_.erase(source);
  }
}

void Fetch::TakeBack(Assembly& assembly, const Source& source) {
  for (const auto& [request, piece] : source.pending) assembly.TakeBack(piece);
  in_flight_ -= source.pending.size();
}

void Fetch::StartAnew(Assembly& assembly) {
  // A complete assembly has nothing pending.
  for (auto source = sources_.rbegin(); source != sources_.rend(); ++source) {
    candidates_.push_front(source->candidate);
  }
  sources_.clear();
  const Status reason = Corrupt("not the artifact of that digest");
  if (contributors_.size() == 1) {
    const ArtifactLocation liar = contributors_.front();
    std::erase_if(candidates_, [&](const Candidate& candidate) { return candidate.location == liar; });
    Blame(liar, reason);
  } else {
    alone_ = true;
  }
  assembly.Reset();
  contributors_.clear();
}

void Fetch::Blame(const ArtifactLocation& location, const Status& reason) {
  const std::string told = failure_.message().empty() ? "" : failure_.message() + "; ";
  const bool corrupt = failure_.code() == ErrorCode::kCorrupt || reason.code() == ErrorCode::kCorrupt;
  failure_ = Status(corrupt ? ErrorCode::kCorrupt : ErrorCode::kUnavailable,
                    told + location.endpoint + ": " + reason.message());
}

}  // namespace depthfarm
