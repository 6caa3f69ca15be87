#include "common/files/state_folder.h"

#include <cstdlib>

namespace depthfarm {

Result<std::string> StateFolder() {
  // NOLINTBEGIN(concurrency-mt-unsafe): no program of ours changes its environment
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  // NOLINTEND(concurrency-mt-unsafe)
  std::string folder = state != nullptr ? state : "";
  if (folder.empty() && home != nullptr && *home != '\0') folder = std::string(home) + "/.local/state";
  if (folder.empty() || folder.front() != '/') return InvalidArgument("neither XDG_STATE_HOME nor HOME is set");
  return folder + "/depthfarm";
}

}  // namespace depthfarm
