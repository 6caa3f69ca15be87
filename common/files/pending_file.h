#ifndef DEPTHFARM_COMMON_FILES_PENDING_FILE_H_
#define DEPTHFARM_COMMON_FILES_PENDING_FILE_H_

#include <string>

#include "common/base/status.h"

namespace depthfarm {

// The end of a name that no other process, of whatever host, and no other call makes.
[[nodiscard]] std::string UniqueSuffix();

// A file that is written under a temporary name beside `path` and gets its own when it is whole: a reader sees the old
// file, the new one or none. Dies without Commit: the temporary file is removed. Makes nothing itself; who writes
// closes before Commit. One owner.
class PendingFile {
 public:
  explicit PendingFile(std::string path);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile();

  [[nodiscard]] const std::string& path() const { return path_; }
  // Distinct among all processes that share the folder.
  [[nodiscard]] const std::string& temporary() const { return temporary_; }

  // Errors  kUnavailable, naming the path and the system's reason: it cannot be renamed.
  [[nodiscard]] Status Commit();

 private:
  std::string path_;
  std::string temporary_;
  bool committed_ = false;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_PENDING_FILE_H_
