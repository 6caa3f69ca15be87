#ifndef DEPTHFARM_TESTS_COORDINATOR_SERVICE_FAKE_PEERS_H_
#define DEPTHFARM_TESTS_COORDINATOR_SERVICE_FAKE_PEERS_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/wire/envelope.h"
#include "coordinator/service/coordinator_server.h"

namespace depthfarm {

// Somebody who talks to a coordinator.
class FakePeer {
 public:
  FakePeer(TransportContext& context, const std::string& endpoint, const ClientOptions& options = {});
  void Send(const v1::Envelope& envelope);
  void SendBytes(const std::string& bytes);
  // The next message; an empty envelope when none comes in ten seconds.
  [[nodiscard]] v1::Envelope Receive();
  // The same, but nothing when none comes in a fifth of a second.
  [[nodiscard]] std::optional<v1::Envelope> TryReceive();
  // The next message of a kind; others are skipped.
  [[nodiscard]] v1::Envelope Await(v1::Envelope::BodyCase kind);
  [[nodiscard]] v1::Envelope Call(const v1::Envelope& request);

  std::uint32_t minor = kProtocolMinor;  // that it says it speaks

 private:
  std::unique_ptr<ClientChannel> channel_;
};

// A worker that answers tasks with made-up artifacts and files.
class FakeFarmWorker {
 public:
  FakeFarmWorker(TransportContext& context, const std::string& endpoint, std::string name,
                 const ClientOptions& options = {});
  void Hello();
  void Ask();
  void Report(const v1::GrantTask& grant);
  // Takes and reports tasks until the job has ended for it; the number of tasks.
  int WorkUntilJobEnds();

  FakePeer peer;
  std::uint64_t asks = 0;

 private:
  std::string name_;
};

// A coordinator that runs in a thread of its own.
class RunningCoordinator {
 public:
  explicit RunningCoordinator(const CoordinatorOptions& options);
  ~RunningCoordinator();
  [[nodiscard]] const std::string& endpoint() const { return coordinator_->endpoint(); }
  // Has it read the list of keys again.
  void RereadKeys() { coordinator_->RereadKeys(); }
  // Waits for the end that somebody else asked for.
  void Join() { thread_.join(); }

 private:
  std::unique_ptr<CoordinatorServer> coordinator_;
  std::thread thread_;
};

[[nodiscard]] v1::Envelope SubmitRequest(int frames, const std::string& output_dir);
[[nodiscard]] v1::Envelope StatusRequest(std::uint64_t job);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COORDINATOR_SERVICE_FAKE_PEERS_H_
