#ifndef DEPTHFARM_COORDINATOR_CLI_EXIT_CODES_H_
#define DEPTHFARM_COORDINATOR_CLI_EXIT_CODES_H_

#include "common/base/status.h"

namespace depthfarm {

// What `depthfarm` returns to the shell.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitBadInput = 2;       // bad usage or bad input: the same call will never work
inline constexpr int kExitNoCoordinator = 3;  // nobody answered at the coordinator's address, or it refused the key
inline constexpr int kExitInterrupted = 130;  // Ctrl-C or SIGTERM

// The exit code of a failure that did not come from talking to a coordinator.
[[nodiscard]] constexpr int ExitCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kOk:
      return kExitOk;
    case ErrorCode::kInvalidArgument:
      return kExitBadInput;
    case ErrorCode::kCancelled:
      return kExitInterrupted;
    case ErrorCode::kCorrupt:
    case ErrorCode::kUnavailable:
    case ErrorCode::kLeaseExpired:
    case ErrorCode::kIncompatible:
    case ErrorCode::kInternal:
      return kExitFailed;
  }
  return kExitFailed;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_EXIT_CODES_H_
