#ifndef DEPTHFARM_COMMON_FILES_STATE_FOLDER_H_
#define DEPTHFARM_COMMON_FILES_STATE_FOLDER_H_

#include <string>

#include "common/base/status.h"

namespace depthfarm {

// Where programs keep what outlives them, of this user: $XDG_STATE_HOME/depthfarm, or ~/.local/state/depthfarm. It need
// not be there yet. kInvalidArgument: neither variable names an absolute path; the message ends before what to do.
[[nodiscard]] Result<std::string> StateFolder();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_STATE_FOLDER_H_
