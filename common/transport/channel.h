#ifndef DEPTHFARM_COMMON_TRANSPORT_CHANNEL_H_
#define DEPTHFARM_COMMON_TRANSPORT_CHANNEL_H_

#include <cstdint>

namespace depthfarm {

// The largest message of the farm; artifacts travel in chunks of 1 MiB.
inline constexpr std::int64_t kMaxMessageBytes = std::int64_t{64} << 20;
// Messages that wait for one peer; more are dropped.
inline constexpr int kMaxQueuedMessages = 10'000;

// What a Poller can wait for. A channel belongs to one thread at a time.
class Channel {
 public:
  virtual ~Channel() = default;
  // The messaging library's socket, for Poller.
  [[nodiscard]] virtual void* native_socket() const = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_CHANNEL_H_
