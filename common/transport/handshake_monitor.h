#ifndef DEPTHFARM_COMMON_TRANSPORT_HANDSHAKE_MONITOR_H_
#define DEPTHFARM_COMMON_TRANSPORT_HANDSHAKE_MONITOR_H_

#include <atomic>
#include <cstdint>
#include <thread>
#include <zmq.hpp>

namespace depthfarm {

// Internal to transport. Counts the handshakes that failed at a socket, in a thread of its own: the library's I/O
// thread waits for whoever does not read its events.
class HandshakeMonitor {
 public:
  // `server` must outlive it and not be bound yet. Throws zmq::error_t.
  HandshakeMonitor(zmq::context_t& context, zmq::socket_t& server);
  ~HandshakeMonitor();
  HandshakeMonitor(const HandshakeMonitor&) = delete;
  HandshakeMonitor& operator=(const HandshakeMonitor&) = delete;

  // By a key that is not listed.
  [[nodiscard]] std::uint64_t wrong_key() const { return wrong_key_; }
  // That broke the protocol, or were made for another server's key.
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }
  // By somebody who said nothing for too long, or went.
  [[nodiscard]] std::uint64_t unfinished() const { return unfinished_; }

 private:
  void Count(zmq::socket_t events);

  zmq::socket_t& server_;
  std::atomic<std::uint64_t> wrong_key_ = 0;
  std::atomic<std::uint64_t> malformed_ = 0;
  std::atomic<std::uint64_t> unfinished_ = 0;
  std::thread thread_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_HANDSHAKE_MONITOR_H_
