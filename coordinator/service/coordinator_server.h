#ifndef DEPTHFARM_COORDINATOR_SERVICE_COORDINATOR_SERVER_H_
#define DEPTHFARM_COORDINATOR_SERVICE_COORDINATOR_SERVER_H_

#include <atomic>
#include <memory>
#include <string>

#include "common/base/status.h"
#include "common/transport/context.h"
#include "common/transport/farm_keys.h"
#include "common/transport/poller.h"
#include "common/transport/server_channel.h"
#include "coordinator/metrics/metrics_server.h"
#include "coordinator/service/coordinator.h"
#include "coordinator/service/refusals.h"

namespace depthfarm {

// The daemon: one socket, one thread, a Coordinator.
class CoordinatorServer {
 public:
  // Reads keys, opens the journal, goes on with the jobs in it, and binds. Errors: kInvalidArgument (options, keys,
  // security), kUnavailable (address or journal in use), those of Journal::Open.
  [[nodiscard]] static Result<std::unique_ptr<CoordinatorServer>> Create(const CoordinatorOptions& options);

  // Where it listens in fact.
  [[nodiscard]] const std::string& endpoint() const { return channel_->endpoint(); }
  // Where metrics are served; only with CoordinatorOptions::metrics.
  [[nodiscard]] const std::string& metrics_address() const { return metrics_->address(); }
  // Serves until Stop or a client's StopCoordinator. Workers are told to stop by the latter, and where there is no
  // journal that another coordinator would go on from; else they go on computing and wait for that one.
  [[nodiscard]] Status Run();
  // Ends Run soon. From any thread, and from signal handlers.
  void Stop();
  // Has Run read the list of authorized keys again: who is no longer on it is refused from then on. With an error in it
  // the old one stays, which the log tells. From any thread, and from signal handlers.
  void RereadKeys();

 private:
  CoordinatorServer() = default;
  void SendOutgoing();
  void RereadIfAsked();
  void LogRefusals(TimePoint now);
  static void LogRefused(const ServerRefusals& server, const MessageRefusals& messages);
  void PublishMetrics(TimePoint now);

  std::string keys_dir_;  // empty: no CURVE
  bool keeps_journal_ = false;
  AllowedKeys allowed_;
  TransportContext context_;
  std::unique_ptr<ServerChannel> channel_;
  Poller poller_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> reread_{false};
  RefusalPace pace_;
  std::unique_ptr<Coordinator> coordinator_;
  std::string version_;
  std::unique_ptr<MetricsServer> metrics_;  // null: none
  TimePoint published_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_COORDINATOR_SERVER_H_
