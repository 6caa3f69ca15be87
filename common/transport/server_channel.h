#ifndef DEPTHFARM_COMMON_TRANSPORT_SERVER_CHANNEL_H_
#define DEPTHFARM_COMMON_TRANSPORT_SERVER_CHANNEL_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/shared_bytes.h"
#include "common/base/status.h"
#include "common/transport/channel.h"
#include "common/transport/context.h"

namespace depthfarm {

struct ServerOptions {
  std::string curve_secret_key = {};  // Z85; empty: no CURVE (ipc, or loopback by explicit wish: see CheckSecurity)
  std::int64_t max_message_bytes = kMaxMessageBytes;
  std::chrono::milliseconds linger{500};         // how long the end of the channel waits for queued messages to leave
  int max_queued_messages = kMaxQueuedMessages;  // waiting for one peer
};

// One message and whom it came from.
struct PeerMessage {
  std::string peer;     // opaque: pass to Send
  std::string user_id;  // "role:name" that the key has now (TransportContext::Readmit); empty without CURVE
  std::string payload;
  std::string key = {};  // the sender's public key; empty without CURVE
};

// What a server did not let in or skipped, since it was bound; handshakes are counted with CURVE only.
struct ServerRefusals {
  std::uint64_t handshakes_wrong_key = 0;   // by a key that is not listed
  std::uint64_t handshakes_malformed = 0;   // that broke the protocol, or were made for another server's key
  std::uint64_t handshakes_unfinished = 0;  // by somebody who said nothing for too long, or went
  std::uint64_t messages_removed_key = 0;   // on connections of keys that are no longer listed
  std::uint64_t messages_frames = 0;        // of a wrong number of frames

  [[nodiscard]] std::uint64_t total() const {
    return handshakes_wrong_key + handshakes_malformed + handshakes_unfinished + messages_removed_key + messages_frames;
  }
};

// Many peers, one socket (ROUTER). Not thread-safe.
class ServerChannel : public Channel {
 public:
  // Binds tcp://HOST:PORT or ipc://PATH; port or path "*" choose a free one. A CURVE server needs
  // TransportContext::Authenticate before. kUnavailable: address in use or not of this machine; kInvalidArgument.
  [[nodiscard]] static Result<std::unique_ptr<ServerChannel>> Bind(TransportContext& context,
                                                                   const std::string& endpoint,
                                                                   const ServerOptions& options);
  ~ServerChannel() override;

  // Where it is bound in fact.
  [[nodiscard]] const std::string& endpoint() const;
  // The next message, or none: none waits, or many in a row were skipped. Skipped are messages of a wrong number of
  // frames and those of keys that are no longer admitted.
  [[nodiscard]] Result<std::optional<PeerMessage>> Receive();
  // Never blocks. kUnavailable: the peer is gone or its queue is full.
  [[nodiscard]] Status Send(std::string_view peer, std::string_view payload);
  // With a second frame, which is not copied: it is held until it has left or is dropped.
  [[nodiscard]] Status Send(std::string_view peer, std::string_view payload, SharedBytes attachment);

  [[nodiscard]] ServerRefusals refusals() const;
  [[nodiscard]] void* native_socket() const override;

 private:
  ServerChannel();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_SERVER_CHANNEL_H_
