#ifndef DEPTHFARM_COMMON_TRANSPORT_CONTEXT_H_
#define DEPTHFARM_COMMON_TRANSPORT_CONTEXT_H_

#include <memory>

#include "common/base/status.h"
#include "common/transport/farm_keys.h"

namespace depthfarm {

// The messaging library's state (its I/O threads) shared by the channels of a process. Must outlive them. Thread-safe.
class TransportContext {
 public:
  TransportContext();
  // Waits for channels to deliver what they linger for.
  ~TransportContext();
  TransportContext(const TransportContext&) = delete;
  TransportContext& operator=(const TransportContext&) = delete;

  // From now on CURVE servers of this context admit exactly these keys (ZAP, RFC 27) and report the user id of each
  // message. Call once, before binding a CURVE server. kInternal when called twice.
  [[nodiscard]] Status Authenticate(AllowedKeys allowed);
  // From now on these keys instead. Who is connected with a key that is no longer listed stays so, since the library
  // closes no single connection, but its messages are skipped; a key of another role now has that one.
  // kInternal before Authenticate.
  [[nodiscard]] Status Readmit(AllowedKeys allowed);

  struct State;
  [[nodiscard]] State& state() { return *state_; }  // for the channels

 private:
  std::unique_ptr<State> state_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_CONTEXT_H_
