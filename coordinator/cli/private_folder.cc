#include "coordinator/cli/private_folder.h"

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

// A Unix socket address takes 107 bytes; what comes after the folder's name needs the rest.
constexpr std::size_t kMaxTemporaryRoot = 60;

// Not $XDG_RUNTIME_DIR: that is a small file system in memory, and the caches of a long run do not fit.
fs::path TemporaryRoot() {
  const char* root = std::getenv("TMPDIR");
  if (root == nullptr || root[0] != '/' || std::strlen(root) > kMaxTemporaryRoot) return "/tmp";
  return root;
}

}  // namespace

Result<PrivateFolder> PrivateFolder::Make(const fs::path& parent) {
  std::string pattern = ((parent.empty() ? TemporaryRoot() : parent) / "depthfarm-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    return Unavailable("cannot make a temporary folder " + pattern + ": " + std::strerror(errno));
  }
  return PrivateFolder(fs::path(pattern));
}

PrivateFolder::PrivateFolder(PrivateFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;  // nothing to be done about files that cannot be removed
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace depthfarm
