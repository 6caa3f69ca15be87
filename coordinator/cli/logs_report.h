#ifndef DEPTHFARM_COORDINATOR_CLI_LOGS_REPORT_H_
#define DEPTHFARM_COORDINATOR_CLI_LOGS_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// "frame 3 merge round 0 pair 1", without the job, which the reader knows; "unknown" for kinds of a newer coordinator.
[[nodiscard]] std::string NameWithinJob(const v1::TaskId& task);

// "running", "done", "reused", "failed", "given back", "revoked", "lease expired", "worker lost", "overtaken";
// "unknown" for those of a newer coordinator.
[[nodiscard]] std::string OutcomeName(v1::AttemptOutcome outcome);

// Why the attempt failed and what was logged, a line each, indented; empty if there is nothing.
[[nodiscard]] std::string NotesOf(const v1::TaskAttempt& attempt);

// One line per attempt, "+" behind its number if it is a duplicate; below those that have any, why it failed and what
// was logged.
[[nodiscard]] std::string FormatLogs(const v1::JobLogs& logs);
[[nodiscard]] nlohmann::ordered_json AttemptToJson(const v1::TaskAttempt& attempt);
[[nodiscard]] nlohmann::ordered_json LogsToJson(const v1::JobLogs& logs);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_LOGS_REPORT_H_
