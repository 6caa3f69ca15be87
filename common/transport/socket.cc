#include "common/transport/socket.h"

#include "common/transport/channel.h"

namespace depthfarm {
namespace {

constexpr int kHeartbeatIntervalMs = 500;
constexpr int kHeartbeatTimeoutMs = 1500;
constexpr int kHandshakeMs = 3000;
constexpr int kReconnectMs = 20;
constexpr int kReconnectMaxMs = 2000;
constexpr int kConnectTimeoutMs = 2000;

}  // namespace

void SetCommonOptions(zmq::socket_t& socket, std::int64_t max_message_bytes, std::chrono::milliseconds linger) {
  socket.set(zmq::sockopt::maxmsgsize, max_message_bytes);
  socket.set(zmq::sockopt::linger, static_cast<int>(linger.count()));
  socket.set(zmq::sockopt::heartbeat_ivl, kHeartbeatIntervalMs);
  socket.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeoutMs);
  socket.set(zmq::sockopt::heartbeat_ttl, kHeartbeatTimeoutMs);
  socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
  socket.set(zmq::sockopt::reconnect_ivl, kReconnectMs);
  socket.set(zmq::sockopt::reconnect_ivl_max, kReconnectMaxMs);
  socket.set(zmq::sockopt::connect_timeout, kConnectTimeoutMs);
  socket.set(zmq::sockopt::sndhwm, kMaxQueuedMessages);
  socket.set(zmq::sockopt::rcvhwm, kMaxQueuedMessages);
  socket.set(zmq::sockopt::ipv6, 1);
}

Status SocketFailure(const std::string& doing, const std::string& endpoint, const zmq::error_t& error) {
  return Unavailable("cannot " + doing + " " + endpoint + ": " + error.what());
}

}  // namespace depthfarm
