#ifndef DEPTHFARM_TESTS_COMMON_TRANSPORT_SCRATCH_FOLDER_H_
#define DEPTHFARM_TESTS_COMMON_TRANSPORT_SCRATCH_FOLDER_H_

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace depthfarm {

// A folder of one test, removed at its end. Short, so that a socket's path fits.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "dfXXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COMMON_TRANSPORT_SCRATCH_FOLDER_H_
