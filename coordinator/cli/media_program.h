#ifndef DEPTHFARM_COORDINATOR_CLI_MEDIA_PROGRAM_H_
#define DEPTHFARM_COORDINATOR_CLI_MEDIA_PROGRAM_H_

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "coordinator/cli/processes.h"

namespace depthfarm {

// Runs `depthfarm-media` with `words` to its end; ends it when interrupted (CatchInterruptions).
// `output`: file that stdout and stderr are appended to; empty: those of this process.
// Errors: kUnavailable: the program is not beside this one, or cannot be started; kCancelled: interrupted.
[[nodiscard]] Result<ProcessEnd> RunMedia(const std::vector<std::string>& words,
                                          const std::filesystem::path& output = {});

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_MEDIA_PROGRAM_H_
