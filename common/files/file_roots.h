#ifndef DEPTHFARM_COMMON_FILES_FILE_ROOTS_H_
#define DEPTHFARM_COMMON_FILES_FILE_ROOTS_H_

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// Folders below which the jobs of a worker may name files. Looks at the file system, opens nothing.
class FileRoots {
 public:
  FileRoots() = default;  // everywhere
  // Below `read` and `write` files may be read, below `write` they may be written; without any, everywhere. Errors
  // (kInvalidArgument, naming folder and option): one is not the absolute path of a folder that exists.
  [[nodiscard]] static Result<FileRoots> Of(const std::vector<std::string>& read,
                                            const std::vector<std::string>& write);

  // Whether there are bounds at all.
  [[nodiscard]] bool confined() const { return !read_.empty() || !write_.empty(); }
  // Without symbolic links.
  [[nodiscard]] const std::vector<std::filesystem::path>& read() const { return read_; }
  [[nodiscard]] const std::vector<std::filesystem::path>& write() const { return write_; }

  // Whether a job may read, or make and write, what this path leads to, symbolic links followed; it need not be there.
  // Errors: kInvalidArgument, naming the path, where it leads and the roots; kUnavailable: the system cannot follow it.
  // Who changes a link between this look and the use of the path is stopped by ConfineFiles.
  [[nodiscard]] Status CheckRead(const std::string& path) const;
  [[nodiscard]] Status CheckWrite(const std::string& path) const;

 private:
  [[nodiscard]] std::string Names() const;

  std::vector<std::filesystem::path> read_;
  std::vector<std::filesystem::path> write_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_FILES_FILE_ROOTS_H_
