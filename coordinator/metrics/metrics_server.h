#ifndef DEPTHFARM_COORDINATOR_METRICS_METRICS_SERVER_H_
#define DEPTHFARM_COORDINATOR_METRICS_METRICS_SERVER_H_

#include <chrono>
#include <memory>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// Serves over HTTP, in threads of its own: GET /metrics: what was published last; GET /healthz: 200 "ok" if that was
// less than kHealthy ago, 503 if not: whoever publishes does not run any more. Nothing else, no method but GET and
// HEAD, no authentication: it is for an address that only operators reach.
class MetricsServer {
 public:
  static constexpr std::chrono::seconds kHealthy{10};

  // "HOST:PORT", port * for a free one. kInvalidArgument: it is none; kUnavailable: the address is in use.
  [[nodiscard]] static Result<std::unique_ptr<MetricsServer>> Start(const std::string& address);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  // Where it listens in fact, HOST:PORT.
  [[nodiscard]] const std::string& address() const { return address_; }
  void Publish(std::string text, std::chrono::steady_clock::time_point now);

 private:
  struct State;
  explicit MetricsServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
  std::string address_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_METRICS_METRICS_SERVER_H_
