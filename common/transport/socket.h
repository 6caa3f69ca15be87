#ifndef DEPTHFARM_COMMON_TRANSPORT_SOCKET_H_
#define DEPTHFARM_COMMON_TRANSPORT_SOCKET_H_

#include <chrono>
#include <cstdint>
#include <string>
#include <zmq.hpp>

#include "common/base/status.h"

namespace depthfarm {

// Internal to transport: what every socket of the farm has in common. Throws zmq::error_t.
// ZMTP heartbeats tell a cut network within 1.5 s; peers that do not finish the handshake are let go.
void SetCommonOptions(zmq::socket_t& socket, std::int64_t max_message_bytes, std::chrono::milliseconds linger);

// "cannot <doing> <endpoint>: <reason>" as kUnavailable.
[[nodiscard]] Status SocketFailure(const std::string& doing, const std::string& endpoint, const zmq::error_t& error);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_SOCKET_H_
