#ifndef DEPTHFARM_COORDINATOR_CLI_LOGS_REPORT_H_
#define DEPTHFARM_COORDINATOR_CLI_LOGS_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// "running", "done", "reused", "failed", "given back", "revoked", "lease expired", "worker lost"; "unknown" for those
// of a newer coordinator.
[[nodiscard]] std::string OutcomeName(v1::AttemptOutcome outcome);

// One line per attempt; below those that have any, why it failed and what was logged.
[[nodiscard]] std::string FormatLogs(const v1::JobLogs& logs);
[[nodiscard]] nlohmann::ordered_json LogsToJson(const v1::JobLogs& logs);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_LOGS_REPORT_H_
