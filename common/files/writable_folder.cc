#include "common/files/writable_folder.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace depthfarm {

Status CheckWritableFolder(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path asked = fs::absolute(path, error).lexically_normal();
  if (path.empty() || error) return InvalidArgument("output folder '" + path + "': expected the path of a folder");
  // The nearest that is there; the root always is.
  fs::path there = asked;
  fs::file_status status = fs::status(there, error);
  while (!fs::exists(status) && there.has_relative_path()) {
    there = there.parent_path();
    status = fs::status(there, error);
  }
  if (!fs::is_directory(status)) {
    const bool itself = fs::equivalent(there, asked, error);
    return InvalidArgument("output folder " + path + (itself ? " is a file" : ": " + there.string() + " is a file") +
                           ": choose another folder");
  }
  if (::access(there.c_str(), W_OK | X_OK) == 0) return {};
  return InvalidArgument("output folder " + path + ": cannot write into " + there.string() + ": " +
                         std::generic_category().message(errno) + ": choose another folder");
}

}  // namespace depthfarm
