#include "common/files/open_file.h"

#include <fcntl.h>
#include <sys/stat.h>
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

OpenFile OpenToRead(const std::string& path) {
  // O_NONBLOCK has no effect on regular files.
  return OpenFile(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
}

Result<std::uint64_t> SizeOfRegular(const std::string& path, const OpenFile& file) {
  struct stat facts {};
  if (fstat(file.descriptor(), &facts) != 0) return FileFailure(path, "examine the file");
  if (!S_ISREG(facts.st_mode)) return InvalidArgument(path + ": is not a regular file");
  return static_cast<std::uint64_t>(facts.st_size);
}

Result<std::size_t> ReadUpTo(const std::string& path, const OpenFile& file, std::uint64_t offset,
                             std::span<char> bytes) {
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t got =
        pread(file.descriptor(), bytes.data() + have, bytes.size() - have, static_cast<off_t>(offset + have));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return FileFailure(path, "read the file");
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  return have;
}

}  // namespace depthfarm
