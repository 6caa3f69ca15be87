#include "common/files/open_file.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace depthfarm {

bool OpenFile::Close() {
  if (descriptor_ < 0) return true;
  const int closed = close(descriptor_);
  descriptor_ = -1;
  return closed == 0;
}

Status FileFailure(const std::string& path, const std::string& action) {
  return Unavailable(path + ": cannot " + action + ": " + std::generic_category().message(errno));
}

}  // namespace depthfarm
