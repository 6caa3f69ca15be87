#ifndef DEPTHFARM_COMMON_TRANSPORT_CLIENT_CHANNEL_H_
#define DEPTHFARM_COMMON_TRANSPORT_CLIENT_CHANNEL_H_

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/transport/channel.h"
#include "common/transport/context.h"
#include "common/transport/keys.h"
#include "common/transport/received_message.h"

namespace depthfarm {

struct ClientOptions {
  std::string curve_server_public_key = {};  // Z85; empty: no CURVE
  CurveKeys curve_own = {};                  // with curve_server_public_key
  std::int64_t max_message_bytes = kMaxMessageBytes;
  std::chrono::milliseconds linger{500};  // how long the end of the channel waits for queued messages to leave
};

// One connection to a ServerChannel (DEALER). Connects and reconnects by itself (after 20 to 2000 ms); messages sent
// meanwhile wait in a bounded queue. After a reconnect the server sees a new peer. Not thread-safe.
class ClientChannel : public Channel {
 public:
  // Does not wait for the server. kInvalidArgument: endpoint or keys are no such thing.
  [[nodiscard]] static Result<std::unique_ptr<ClientChannel>> Connect(TransportContext& context,
                                                                      const std::string& endpoint,
                                                                      const ClientOptions& options);
  ~ClientChannel() override;

  [[nodiscard]] const std::string& endpoint() const;
  // Never blocks. kUnavailable: the queue is full.
  [[nodiscard]] Status Send(std::string_view payload);
  // The next message, or none within `timeout` (0: none waiting). Messages of several frames are skipped.
  [[nodiscard]] Result<std::optional<std::string>> Receive(std::chrono::milliseconds timeout);
  // The same for messages of one or two frames; longer ones are skipped.
  [[nodiscard]] Result<std::optional<ReceivedMessage>> ReceiveAttached(std::chrono::milliseconds timeout);

  [[nodiscard]] void* native_socket() const override;

 private:
  ClientChannel();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_CLIENT_CHANNEL_H_
