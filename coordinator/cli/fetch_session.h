#ifndef DEPTHFARM_COORDINATOR_CLI_FETCH_SESSION_H_
#define DEPTHFARM_COORDINATOR_CLI_FETCH_SESSION_H_

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <thread>

#include "common/base/status.h"
#include "common/transport/context.h"
#include "coordinator/cli/farm_options.h"
#include "coordinator/client/client.h"
#include "coordinator/fetching/result_fetch.h"
#include "worker/transfer/artifact_client.h"

namespace depthfarm {

// What the commands that fetch results have in common.

// As FarmArguments say it.
[[nodiscard]] CoordinatorTarget TargetOf(const FarmArguments& farm);
// Of an interrupted program the calls end with kCancelled.
[[nodiscard]] Result<std::unique_ptr<Client>> ConnectTo(const FarmArguments& farm);
// Who fetches from workers with the keys of `farm`. The context must outlive it.
[[nodiscard]] Result<std::unique_ptr<ArtifactClient>> PeersOf(const FarmArguments& farm, TransportContext& context);

// Ends what it is given the token of when the user interrupts (CatchInterruptions).
class StopOnInterruption {
 public:
  StopOnInterruption();
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::jthread watcher_;  // last: ends first
};

[[nodiscard]] nlohmann::ordered_json FetchToJson(const ResultFetch& fetch, std::uint64_t job, const std::string& dir);
// What is here and what is not, and what to do about it.
[[nodiscard]] std::string FormatFetch(const ResultFetch& fetch, std::uint64_t job, const std::string& dir);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_FETCH_SESSION_H_
