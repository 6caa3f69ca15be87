#ifndef DEPTHFARM_COORDINATOR_CLI_INTERRUPTION_H_
#define DEPTHFARM_COORDINATOR_CLI_INTERRUPTION_H_

#include <chrono>

namespace depthfarm {

// From here on SIGINT, SIGTERM and SIGHUP no longer end the process but are remembered, so that commands that own
// processes or files can clean up. SIGPIPE is ignored: a closed stdout must not leave a farm behind.
void CatchInterruptions();

// Whether one of them has come.
[[nodiscard]] bool Interrupted();

// Waits `duration`, less when interrupted.
void PauseUnlessInterrupted(std::chrono::milliseconds duration);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_INTERRUPTION_H_
