#ifndef DEPTHFARM_COMMON_TRANSPORT_ENDPOINT_H_
#define DEPTHFARM_COMMON_TRANSPORT_ENDPOINT_H_

#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// "tcp://HOST:PORT" (host: name, address, [IPv6], or * to listen everywhere; port: 1..65535, or * to listen on a free
// one) or "ipc://PATH".
struct Endpoint {
  enum class Kind { kTcp, kIpc };
  Kind kind = Kind::kTcp;
  std::string host;  // tcp
  std::string port;  // tcp
  std::string path;  // ipc; "*": any free path

  // localhost, 127.0.0.0/8 (also as ::ffff:127.x.x.x) or ::1. An ipc endpoint is local by nature: true.
  [[nodiscard]] bool IsLoopback() const;
  [[nodiscard]] std::string ToString() const;
};

// kInvalidArgument shows the expected form; paths longer than a Unix socket address takes (107 bytes) are refused.
[[nodiscard]] Result<Endpoint> ParseEndpoint(std::string_view text);

// The rule of every socket of the farm: tcp needs CURVE keys; `insecure` lifts that on loopback addresses only.
[[nodiscard]] Status CheckSecurity(const Endpoint& endpoint, bool has_keys, bool insecure);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_ENDPOINT_H_
