#include "coordinator/service/coordinator_server.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <random>
#include <utility>

#include "common/log/log.h"
#include "common/transport/endpoint.h"
#include "common/transport/farm_keys.h"
#include "common/wire/envelope.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kTick{50};
constexpr std::chrono::seconds kPublishInterval{1};
constexpr int kMessagesPerTick = 1000;  // a flood must not keep leases from expiring

}  // namespace

Result<std::unique_ptr<CoordinatorServer>> CoordinatorServer::Create(const CoordinatorOptions& options) {
  DEPTHFARM_RETURN_IF_ERROR(options.Validate());
  DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint endpoint, ParseEndpoint(options.endpoint));
  DEPTHFARM_RETURN_IF_ERROR(CheckSecurity(endpoint, !options.keys_dir.empty(), options.insecure));
  // Leases of an earlier coordinator may still be named by its workers: begin far from them.
  const std::uint64_t first_lease = (std::uint64_t{std::random_device{}() & 0x7fffffffU} << 24U) + 1;
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<Journal> journal,
                             Journal::Open(options.journal, {.kept_jobs = options.kept_jobs}));
  std::unique_ptr<CoordinatorServer> server(new CoordinatorServer);
  server->keys_dir_ = options.keys_dir;
  server->keeps_journal_ = !options.journal.empty();
  const bool secure = !options.keys_dir.empty();
  server->coordinator_ = std::make_unique<Coordinator>(options, first_lease, std::move(journal), secure);
  ServerOptions channel;
  if (secure) {
    DEPTHFARM_ASSIGN_OR_RETURN(CoordinatorKeys keys, ReadCoordinatorKeys(options.keys_dir));
    DEPTHFARM_RETURN_IF_ERROR(server->context_.Authenticate(keys.allowed));
    server->allowed_ = std::move(keys.allowed);
    channel.curve_secret_key = keys.own.secret_key;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(server->channel_, ServerChannel::Bind(server->context_, options.endpoint, channel));
  if (!options.metrics.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(server->metrics_, MetricsServer::Start(options.metrics));
    server->version_ = options.version;
  }
  DEPTHFARM_RETURN_IF_ERROR(server->coordinator_->Restore(std::chrono::steady_clock::now()));
  return server;
}

void CoordinatorServer::Stop() {
  stop_.store(true);
  poller_.Wake();
}

void CoordinatorServer::RereadKeys() {
  reread_.store(true);
  poller_.Wake();
}

Status CoordinatorServer::Run() {
  LogInfo("coordinator_started", {{"endpoint", endpoint()}, {"secure", !keys_dir_.empty()}});
  const std::array<const Channel*, 1> channels = {channel_.get()};
  const auto stopping = [this] { return stop_.load() || coordinator_->asked_to_stop(); };
  while (!stopping()) {
    DEPTHFARM_RETURN_IF_ERROR(poller_.Wait(channels, kTick));
    for (int i = 0; i < kMessagesPerTick && !stopping(); ++i) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<PeerMessage> message, channel_->Receive());
      RereadIfAsked();
      if (!message) break;
      coordinator_->Handle(*message, std::chrono::steady_clock::now());
      SendOutgoing();
    }
    coordinator_->Tick(std::chrono::steady_clock::now());
    SendOutgoing();
    LogRefusals(std::chrono::steady_clock::now());
    coordinator_->LogLeftOut(std::chrono::steady_clock::now());
    PublishMetrics(std::chrono::steady_clock::now());
  }
  // One that will be started again finds its workers at work.
  if (coordinator_->asked_to_stop() || !keeps_journal_) coordinator_->SayGoodbye();
  SendOutgoing();
  // Those of the last minute.
  if (pace_.Owes(channel_->refusals().total() + coordinator_->refusals().total())) {
    LogRefused(channel_->refusals(), coordinator_->refusals());
  }
  coordinator_->LogLeftOut(std::nullopt);
  LogInfo("coordinator_stopped",
          {{"workers", coordinator_->scheduler().Workers().size()}, {"jobs", coordinator_->scheduler().Jobs().size()}});
  return {};
}

void CoordinatorServer::RereadIfAsked() {
  if (!reread_.exchange(false)) return;
  if (keys_dir_.empty()) {
    LogWarning("keys_not_reread", {{"reason", "this coordinator was started without keys"}});
    return;
  }
  Result<AllowedKeys> allowed = ReadAuthorized(std::filesystem::path(keys_dir_) / "authorized");
  const Status replaced = allowed.ok() ? context_.Readmit(*allowed) : allowed.status();
  if (!replaced.ok()) {
    LogWarning("keys_not_reread", {{"reason", replaced.message()}, {"keys", allowed_.size()}});
    return;
  }
  const auto gone = std::ranges::count_if(allowed_, [&](const auto& old) { return !allowed->contains(old.first); });
  const auto added = std::ranges::count_if(*allowed, [&](const auto& key) { return !allowed_.contains(key.first); });
  allowed_ = *std::move(allowed);
  const int workers = coordinator_->DropUnlisted(allowed_, std::chrono::steady_clock::now());
  LogInfo("keys_reread",
          {{"keys", allowed_.size()}, {"added", added}, {"removed", gone}, {"workers_dropped", workers}});
}

void CoordinatorServer::LogRefusals(TimePoint now) {
  const ServerRefusals server = channel_->refusals();
  const MessageRefusals& messages = coordinator_->refusals();
  if (!pace_.Due(server.total() + messages.total(), now)) return;
  LogRefused(server, messages);
}

void CoordinatorServer::LogRefused(const ServerRefusals& server, const MessageRefusals& messages) {
  LogWarning("refused_so_far", {{"handshakes_wrong_key", server.handshakes_wrong_key},
                                {"handshakes_malformed", server.handshakes_malformed},
                                {"handshakes_unfinished", server.handshakes_unfinished},
                                {"messages_removed_key", server.messages_removed_key},
                                {"messages_frames", server.messages_frames},
                                {"messages_malformed", messages.malformed},
                                {"messages_other_version", messages.other_version},
                                {"messages_wrong_role", messages.wrong_role},
                                {"last_user", messages.last_user},
                                {"last_reason", messages.last_reason}});
}

void CoordinatorServer::PublishMetrics(TimePoint now) {
  if (metrics_ == nullptr || now - published_ < kPublishInterval) return;
  published_ = now;
  FarmMetrics metrics = coordinator_->Metrics();
  metrics.version = version_;
  const ServerRefusals refused = channel_->refusals();
  metrics.refused["handshake with a wrong key"] = refused.handshakes_wrong_key;
  metrics.refused["handshake malformed"] = refused.handshakes_malformed;
  metrics.refused["handshake unfinished"] = refused.handshakes_unfinished;
  metrics.refused["message of a removed key"] = refused.messages_removed_key;
  metrics.refused["message of wrong frames"] = refused.messages_frames;
  metrics_->Publish(FormatMetrics(metrics), now);
}

void CoordinatorServer::SendOutgoing() {
  for (OutgoingMessage& message : coordinator_->TakeOutgoing()) {
    const std::string name = BodyName(message.envelope);
    const Status sent = channel_->Send(message.peer, SerializeEnvelope(std::move(message.envelope)));
    // Leases and requests time out; whoever is gone says hello or asks again.
    if (!sent.ok()) LogDebug("message_not_sent", {{"message", name}, {"reason", sent.message()}});
  }
}

}  // namespace depthfarm
