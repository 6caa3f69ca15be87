#include "common/files/user_folders.h"

#include <cstdlib>

namespace depthfarm {
namespace {

// What `variable` names, else `below_home` in the home folder.
Result<std::string> UserFolder(const char* variable, const char* below_home) {
  // NOLINTBEGIN(concurrency-mt-unsafe): no program of ours changes its environment
  const char* named = std::getenv(variable);
  const char* home = std::getenv("HOME");
  // NOLINTEND(concurrency-mt-unsafe)
  std::string folder = named != nullptr ? named : "";
  if (folder.empty() && home != nullptr && *home != '\0') folder = std::string(home) + below_home;
  if (folder.empty() || folder.front() != '/')
    return InvalidArgument("neither " + std::string(variable) + " nor HOME is set");
  return folder + "/depthfarm";
}

}  // namespace

Result<std::string> StateFolder() { return UserFolder("XDG_STATE_HOME", "/.local/state"); }

Result<std::string> CacheFolder() { return UserFolder("XDG_CACHE_HOME", "/.cache"); }

}  // namespace depthfarm
