#ifndef DEPTHFARM_COMMON_TRANSPORT_POLLER_H_
#define DEPTHFARM_COMMON_TRANSPORT_POLLER_H_

#include <chrono>
#include <span>

#include "common/base/status.h"
#include "common/transport/channel.h"

namespace depthfarm {

// Waiting for several channels at once, and for other threads. Wait belongs to one thread; Wake may be called by any
// thread and by signal handlers, before, during or after a Wait, and is never lost.
class Poller {
 public:
  Poller();
  ~Poller();
  Poller(const Poller&) = delete;
  Poller& operator=(const Poller&) = delete;

  // Returns when a channel has a message, Wake was called since the last Wait, a signal came, or `timeout` is over.
  // Then drain every channel (Receive until none). kInternal when the messaging library fails.
  [[nodiscard]] Status Wait(std::span<const Channel* const> channels, std::chrono::milliseconds timeout);
  void Wake();

 private:
  int wake_fd_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_POLLER_H_
