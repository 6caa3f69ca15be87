#include "worker/service/death_notice.h"

#include <chrono>
#include <memory>
#include <vector>

#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/transport/endpoint.h"
#include "common/transport/farm_keys.h"
#include "worker/service/messages.h"

namespace depthfarm {
namespace {

// Whoever starts workers again waits for it when the coordinator is away: well less than a lease, which ends then.
constexpr std::chrono::milliseconds kPatience{3000};

}  // namespace

Status SendDeathNotice(const WorkerOptions& options, const std::string& how, const TaskLog& last_words) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint coordinator, ParseEndpoint(options.coordinator));
  ClientOptions channel_options;
  channel_options.linger = kPatience;
  if (!options.keys.empty() && coordinator.kind == Endpoint::Kind::kTcp) {
    DEPTHFARM_ASSIGN_OR_RETURN(const WorkerKeys keys, ReadWorkerKeys(options.keys));
    channel_options.curve_server_public_key = keys.coordinator_public_key;
    channel_options.curve_own = keys.own;
  }
  TransportContext context;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<ClientChannel> channel,
                             ClientChannel::Connect(context, options.coordinator, channel_options));
  const std::vector<LeaseId> computing = options.computing ? options.computing->List() : std::vector<LeaseId>{};
  return channel->Send(SerializeEnvelope(DiedMessage(options.name, options.process, how, last_words, computing)));
}

}  // namespace depthfarm
