#ifndef DEPTHFARM_COMMON_FILES_OPEN_FILE_H_
#define DEPTHFARM_COMMON_FILES_OPEN_FILE_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// A file descriptor, closed on every way out. One owner.
class OpenFile {
 public:
  // What open() returned: below 0 nothing is open.
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { (void)Close(); }

  [[nodiscard]] bool ok() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  // False when closing tells of an error in what was written; a second call does nothing.
  [[nodiscard]] bool Close();

 private:
  int descriptor_;
};

// kUnavailable "<path>: cannot <action>: <the system's reason>", the reason by errno.
[[nodiscard]] Status FileFailure(const std::string& path, const std::string& action);

// Opens a file to read it; a pipe without a writer does not make it wait. Not ok(): see FileFailure.
[[nodiscard]] OpenFile OpenToRead(const std::string& path);

// Bytes of a regular file. `path` is for the message. Errors: kUnavailable when it cannot be examined;
// kInvalidArgument: it is not a regular file (a pipe would block, a folder has no bytes).
[[nodiscard]] Result<std::uint64_t> SizeOfRegular(const std::string& path, const OpenFile& file);

// From `offset` on, as many bytes as there are, at most as `bytes` has room for; returns how many. `path` is for the
// message. Errors: kUnavailable when the file cannot be read.
[[nodiscard]] Result<std::size_t> ReadUpTo(const std::string& path, const OpenFile& file, std::uint64_t offset,
                                           std::span<char> bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_OPEN_FILE_H_
