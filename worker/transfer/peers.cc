#include "worker/transfer/peers.h"

#include <algorithm>
#include <utility>

namespace depthfarm {
namespace {

constexpr std::size_t kMaxPeers = 64;

std::string PeerName(const ArtifactLocation& location) { return location.endpoint + " " + location.public_key; }

}  // namespace

Result<std::shared_ptr<ClientChannel>> Peers::Connect(const ArtifactLocation& location) {
  if (Remembered(distrusted_, location)) return Unavailable("was silent a moment ago");
  const std::string name = PeerName(location);
  const auto known = peers_.find(name);
  if (known != peers_.end()) {
    known->second.last_use = ++uses_;
    return known->second.channel;
  }
  if (peers_.size() >= kMaxPeers) {
    peers_.erase(std::ranges::min_element(peers_, {}, [](const auto& peer) { return peer.second.last_use; }));
  }
  ClientOptions options;
  options.curve_server_public_key = location.public_key;
  options.linger = std::chrono::milliseconds(0);
  options.max_message_bytes = max_message_bytes_;
  if (!location.public_key.empty()) {
    if (own_keys_.public_key.empty()) return Unavailable("needs a key and this worker has none");
    options.curve_own = own_keys_;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(std::shared_ptr<ClientChannel> channel,
                             ClientChannel::Connect(context_, location.endpoint, options));
  peers_[name] = {channel, ++uses_};
  return channel;
}

void Peers::Forget(const ArtifactLocation& location) { peers_.erase(PeerName(location)); }

void Peers::Postpone(const ArtifactLocation& location) {
  Forget(location);
  postponed_[PeerName(location)] = Clock::now() + memory_;
}

void Peers::Distrust(const ArtifactLocation& location) {
  Forget(location);
  distrusted_[PeerName(location)] = Clock::now() + memory_;
}

bool Peers::Remembered(Memory& memory, const ArtifactLocation& location) {
  const Clock::time_point now = Clock::now();
  std::erase_if(memory, [now](const auto& entry) { return entry.second <= now; });
  return memory.contains(PeerName(location));
}

}  // namespace depthfarm
