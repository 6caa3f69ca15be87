#ifndef DEPTHFARM_COMMON_FILES_WRITABLE_FOLDER_H_
#define DEPTHFARM_COMMON_FILES_WRITABLE_FOLDER_H_

#include <string>

#include "common/base/status.h"

namespace depthfarm {

// Whether this process may write into the folder `path`, or make it where it is not there yet; makes nothing. For what
// a user names: to be asked before work that would end in vain. Errors  kInvalidArgument, naming `path` and what is in
// the way: it or something above it is a file, no permission, a
//         file system that is read-only.
[[nodiscard]] Status CheckWritableFolder(const std::string& path);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_WRITABLE_FOLDER_H_
