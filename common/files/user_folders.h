#ifndef DEPTHFARM_COMMON_FILES_USER_FOLDERS_H_
#define DEPTHFARM_COMMON_FILES_USER_FOLDERS_H_

#include <string>

#include "common/base/status.h"

namespace depthfarm {

// Folders of this user (XDG Base Directory Specification). They need not be there yet. kInvalidArgument: neither
// variable names an absolute path; the message ends before what to do.

// Where programs keep what outlives them: $XDG_STATE_HOME/depthfarm, or ~/.local/state/depthfarm.
[[nodiscard]] Result<std::string> StateFolder();
// What can be made again, kept to save the time: $XDG_CACHE_HOME/depthfarm, or ~/.cache/depthfarm.
[[nodiscard]] Result<std::string> CacheFolder();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_USER_FOLDERS_H_
