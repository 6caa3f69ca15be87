#ifndef DEPTHFARM_COORDINATOR_FETCHING_FETCHED_FOLDER_H_
#define DEPTHFARM_COORDINATOR_FETCHING_FETCHED_FOLDER_H_

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/files/open_file.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// The folder that the results of a job are fetched into. In the end it is what the job would have written itself:
//
//   DIR/.depthfarm-job            marker while files are missing: names the job, so that a later fetch of it goes on
//   DIR/.depthfarm-staging/fetch  the file that is being written
//   DIR/depth/<camera>/<frame>.png, DIR/confidence/<camera>/<frame>.png
//   DIR/depth.json                last of all
//
// Errors: kInvalidArgument: the folder holds something else; kUnavailable: files cannot be written. All name the path.
class FetchedFolder {
 public:
  // Makes the folder, or takes up one that is there. `identity` is a word that equal jobs have in common. Refused when
  // another job owns it, another fetch writes there, or its depth was not made by depthfarm. One that holds the
  // finished result of a job is accepted: see finished().
  [[nodiscard]] static Result<FetchedFolder> Open(const std::filesystem::path& dir, const std::string& identity);

  // The depth.json that is there already: then only the same job's files may be added.
  [[nodiscard]] const std::optional<std::string>& finished() const { return finished_; }
  [[nodiscard]] const std::filesystem::path& path() const { return dir_; }

  // Whether the file is there, with this content.
  [[nodiscard]] bool Has(const std::string& file, const FileDigest& digest) const;
  // Writes a file under another name and renames it. `file` is one that FilesOfFrame names.
  [[nodiscard]] Status Write(const std::string& file, std::string_view bytes) const;
  // Writes depth.json and gives the folder up.
  [[nodiscard]] Status Finish(const std::string& manifest) const;

 private:
  explicit FetchedFolder(std::filesystem::path dir) : dir_(std::move(dir)) {}
  [[nodiscard]] Status Lock(const std::string& marker);

  std::filesystem::path dir_;
  std::unique_ptr<OpenFile> marker_;  // locked: one fetch at a time
  std::optional<std::string> finished_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_FETCHING_FETCHED_FOLDER_H_
