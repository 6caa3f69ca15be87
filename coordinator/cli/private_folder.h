#ifndef DEPTHFARM_COORDINATOR_CLI_PRIVATE_FOLDER_H_
#define DEPTHFARM_COORDINATOR_CLI_PRIVATE_FOLDER_H_

#include <filesystem>

#include "common/base/status.h"

namespace depthfarm {

// A new folder below `parent`, or below $TMPDIR (or /tmp), that only this user may enter (0700), with a name
// short enough, in the latter case, for sockets in it. The folder and all that is in it go with this object.
class PrivateFolder {
 public:
  // kUnavailable: it cannot be made.
  [[nodiscard]] static Result<PrivateFolder> Make(const std::filesystem::path& parent = {});
  PrivateFolder(PrivateFolder&& other) noexcept;
  PrivateFolder& operator=(PrivateFolder&& other) = delete;
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  ~PrivateFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit PrivateFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  // empty: moved from
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_PRIVATE_FOLDER_H_
