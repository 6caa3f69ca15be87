#ifndef DEPTHFARM_WORKER_TRANSFER_PEERS_H_
#define DEPTHFARM_WORKER_TRANSFER_PEERS_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/transport/keys.h"

namespace depthfarm {

// Connections to artifact servers, kept from one fetch to the next, and what is remembered of those that were slow.
class Peers {
 public:
  // `own_keys` without a public key: only locations without one can be used. Answers are at most `max_message_bytes`.
  Peers(TransportContext& context, CurveKeys own_keys, std::int64_t max_message_bytes, std::chrono::milliseconds memory)
      : context_(context), own_keys_(std::move(own_keys)), max_message_bytes_(max_message_bytes), memory_(memory) {}

  // Errors: kUnavailable: it was silent a moment ago, or needs a key and there is none; kInvalidArgument: no endpoint.
  [[nodiscard]] Result<std::shared_ptr<ClientChannel>> Connect(const ArtifactLocation& location);
  // It was late: as Forget, and others come before it for a while.
  void Postpone(const ArtifactLocation& location);
  [[nodiscard]] bool Postponed(const ArtifactLocation& location) { return Remembered(postponed_, location); }
  // What is still on the way there goes with its connection.
  void Forget(const ArtifactLocation& location);
  // It was silent: its connection ends, and is not made again for a while.
  void Distrust(const ArtifactLocation& location);
  // Never used before.
  [[nodiscard]] std::uint64_t NextRequest() { return ++last_request_; }

 private:
  using Clock = std::chrono::steady_clock;
  using Memory = std::map<std::string, Clock::time_point>;  // by endpoint and key; until when
  struct Peer {
    std::shared_ptr<ClientChannel> channel;
    std::uint64_t last_use = 0;
  };
  [[nodiscard]] static bool Remembered(Memory& memory, const ArtifactLocation& location);

  TransportContext& context_;
  const CurveKeys own_keys_;
  const std::int64_t max_message_bytes_;
  const std::chrono::milliseconds memory_;
  std::map<std::string, Peer> peers_;  // by endpoint and key
  Memory postponed_;
  Memory distrusted_;
  std::uint64_t last_request_ = 0;
  std::uint64_t uses_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_PEERS_H_
