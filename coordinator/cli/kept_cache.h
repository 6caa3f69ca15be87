#ifndef DEPTHFARM_COORDINATOR_CLI_KEPT_CACHE_H_
#define DEPTHFARM_COORDINATOR_CLI_KEPT_CACHE_H_

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// The folder in which the workers of one `depthfarm run` leave their artifacts for the next one.
struct KeptCache {
  std::filesystem::path folder;  // empty: nothing is kept
  std::uint64_t bytes = 0;       // its bound
  std::string note;              // why nothing is kept although nobody asked for that; else empty
};

// Makes the folder `asked`, or, if that is empty, the user's: $XDG_CACHE_HOME/depthfarm/artifacts, or the same in
// ~/.cache, closed to others. There nothing is kept (see `note`) if it cannot be made, belongs to another user, or is
// on a network file system: locks and the order of use are of one host (worker/artifacts/shared_folder.h), and what
// travels costs more than it saves.
// Errors  kInvalidArgument: the folder asked for cannot be made.
[[nodiscard]] Result<KeptCache> OpenKeptCache(const std::string& asked);

// 8 GiB, but at most a tenth of a file system of so many bytes, and at least 1 GiB.
[[nodiscard]] std::uint64_t KeptCacheBytes(std::uint64_t file_system_bytes);

// Of statfs(2): whether other hosts have it too.
[[nodiscard]] bool IsNetworkFileSystem(std::int64_t type);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_KEPT_CACHE_H_
