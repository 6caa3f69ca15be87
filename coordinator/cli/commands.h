#ifndef DEPTHFARM_COORDINATOR_CLI_COMMANDS_H_
#define DEPTHFARM_COORDINATOR_CLI_COMMANDS_H_

#include "common/base/status.h"
#include "coordinator/cli/arguments.h"

namespace depthfarm {

// Each command: results on stdout, progress and errors on stderr, the exit code (exit_codes.h) as its result.
[[nodiscard]] int Execute(const DemoArguments& arguments);
[[nodiscard]] int Execute(const RunArguments& arguments);
[[nodiscard]] int Execute(const PlanArguments& arguments);
[[nodiscard]] int Execute(const BenchArguments& arguments);
[[nodiscard]] int Execute(const SubmitArguments& arguments);
// Of submit, with --upload.
[[nodiscard]] int SubmitWithUploads(const SubmitArguments& arguments);
[[nodiscard]] int Execute(const StatusArguments& arguments);
[[nodiscard]] int Execute(const WatchArguments& arguments);
[[nodiscard]] int Execute(const LogsArguments& arguments);
[[nodiscard]] int Execute(const JobsArguments& arguments);
[[nodiscard]] int Execute(const CancelArguments& arguments);
[[nodiscard]] int Execute(const RetryArguments& arguments);
[[nodiscard]] int Execute(const WorkersArguments& arguments);
[[nodiscard]] int Execute(const DrainArguments& arguments);
[[nodiscard]] int Execute(const FetchArguments& arguments);
[[nodiscard]] int Execute(const VerifyArguments& arguments);
[[nodiscard]] int Execute(const ImportArguments& arguments);
[[nodiscard]] int Execute(const KeygenArguments& arguments);
[[nodiscard]] int Execute(const ClusterArguments& arguments);

// Says on stderr what failed and returns the exit code for it.
[[nodiscard]] int Fail(const Status& status);
// The same for a failure of Client, where "unavailable" means: no coordinator.
[[nodiscard]] int FailAsking(const Status& status);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_COMMANDS_H_
