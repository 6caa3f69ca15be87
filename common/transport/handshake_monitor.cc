#include "common/transport/handshake_monitor.h"

#include <signal.h>  // NOLINT(modernize-deprecated-headers): pthread_sigmask is POSIX

#include <cstring>
#include <string>
#include <utility>

namespace depthfarm {
namespace {

constexpr int kEvents = ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                        ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_MONITOR_STOPPED;

}  // namespace

HandshakeMonitor::HandshakeMonitor(zmq::context_t& context, zmq::socket_t& server) : server_(server) {
  static std::atomic<std::uint64_t> monitors = 0;
  const std::string endpoint = "inproc://depthfarm-handshakes-" + std::to_string(++monitors);
  if (zmq_socket_monitor(server.handle(), endpoint.c_str(), kEvents) != 0) throw zmq::error_t();
  zmq::socket_t events(context, zmq::socket_type::pair);
  events.connect(endpoint);
  thread_ = std::thread([this, socket = std::move(events)]() mutable { Count(std::move(socket)); });
}

HandshakeMonitor::~HandshakeMonitor() {
  zmq_socket_monitor(server_.handle(), nullptr, 0);  // its last event ends the thread
  thread_.join();
}

void HandshakeMonitor::Count(zmq::socket_t events) {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
  try {
    for (;;) {
      zmq::message_t event;
      zmq::message_t address;
      if (!events.recv(event) || !event.more() || !events.recv(address)) continue;
      std::uint16_t kind = 0;
      std::memcpy(&kind, event.data(), sizeof(kind));
      if (kind == ZMQ_EVENT_MONITOR_STOPPED) return;
      if (kind == ZMQ_EVENT_HANDSHAKE_FAILED_AUTH) ++wrong_key_;
      if (kind == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL) ++malformed_;
      if (kind == ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL) ++unfinished_;
    }
  } catch (const zmq::error_t&) {
    return;  // the context ends, and what is counted with it
  }
}

}  // namespace depthfarm
