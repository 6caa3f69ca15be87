#ifndef DEPTHFARM_TESTS_BENCHMARKS_BARE_TRANSFER_H_
#define DEPTHFARM_TESTS_BENCHMARKS_BARE_TRANSFER_H_

#include <cstddef>
#include <memory>
#include <string>

#include "common/transport/keys.h"
#include "tests/benchmarks/server_process.h"

namespace depthfarm::benchmarks {

// What ZeroMQ itself can do: DEALER asks ROUTER for messages of 4 MiB, four of them under way. The sender copies each
// from the bytes in memory, as zmq_send does; the receiver drops it. Nothing is parsed, kept or checked but sizes.
inline constexpr std::size_t kBareMessageBytes = std::size_t{4} << 20;

// In the child. Keys without a public key: no CURVE.
[[nodiscard]] ServerProcess::Served ServeBare(const std::string& bytes, const CurveKeys& keys);

class BareReceiver {
 public:
  BareReceiver(const std::string& endpoint, const CurveKeys& keys);
  ~BareReceiver();
  // Receives `total_bytes`; false when something else comes.
  [[nodiscard]] bool Receive(std::size_t total_bytes);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_BARE_TRANSFER_H_
