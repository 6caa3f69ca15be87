#ifndef DEPTHFARM_TESTS_WORKER_ARTIFACTS_TEMPORARY_FOLDER_H_
#define DEPTHFARM_TESTS_WORKER_ARTIFACTS_TEMPORARY_FOLDER_H_

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace depthfarm {

// A private folder for one test, removed with all it holds.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "depthfarm-test-XXXXXX").string();
    path_ = mkdtemp(name.data()) == nullptr ? std::string() : name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_ARTIFACTS_TEMPORARY_FOLDER_H_
