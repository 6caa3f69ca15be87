#ifndef DEPTHFARM_WORKER_EXECUTION_OUTPUT_FOLDER_H_
#define DEPTHFARM_WORKER_EXECUTION_OUTPUT_FOLDER_H_

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// What a job makes.
enum class OutputContent {
  kDepth,  // DIR/depth, DIR/confidence, DIR/depth.json
  kViews,  // DIR/views, DIR/views.json
};

// The folder of a job's result, DIR, and the only code that writes into it:
//
//   DIR/.depthfarm-job              marker: a job owns the folder (DIR/.depthfarm-views-job)
//   DIR/.depthfarm-staging/<name>/  files of one attempt of Emit or Render
//   DIR/depth/<camera>/<frame>.png  committed files; DIR/confidence/<camera>/<frame>.png, DIR/views/<number>.png
//   DIR/depth.json, DIR/views.json  last of all
//
// Files are named relative to DIR. Every path from a task is checked to be plain names below these. Every function may
// be called again after a worker died in the middle of it. Errors: kInvalidArgument for paths and foreign folders, else
// kUnavailable; all name the path.
class OutputFolder {
 public:
  // Touches nothing. kInvalidArgument unless `dir` is absolute and without "..".
  [[nodiscard]] static Result<OutputFolder> At(const std::string& dir, OutputContent content = OutputContent::kDepth);

  // Makes the folder ready for a job: an older result of the same content is removed. kInvalidArgument when one of the
  // folders of such a result exists but nothing says that depthfarm made it: no marker, and no manifest that names
  // files there.
  [[nodiscard]] Status Prepare() const;
  // Makes the folder ready for a job that goes on: these files of it must be there. Sizes are checked of all and
  // contents of some, so that another job's files are found out. kInvalidArgument names the first one that is not as it
  // should.
  [[nodiscard]] Status Resume(const std::vector<OutputFile>& files) const;
  // Writes a file of an attempt, in whole or not at all. kUnavailable when the folder belongs to no job (any more).
  [[nodiscard]] Status Stage(const std::string& staging, const std::string& path, std::string_view bytes) const;
  // Renames an attempt's files into place and removes its folder. kCorrupt when a file is not what its digest says,
  // kUnavailable when it is in neither place.
  [[nodiscard]] Status Commit(const std::string& staging, const std::vector<OutputFile>& files) const;
  // Writes depth.json or views.json, of which this is the text, and gives the folder up.
  [[nodiscard]] Status Finish(std::string_view manifest) const;
  // Removes all attempts. The marker stays: the next job may take the folder over.
  [[nodiscard]] Status RemoveStaging() const;

 private:
  OutputFolder(std::filesystem::path dir, OutputContent content) : dir_(std::move(dir)), content_(content) {}
  [[nodiscard]] std::filesystem::path Manifest() const;
  [[nodiscard]] std::filesystem::path Marker() const;
  [[nodiscard]] std::vector<std::filesystem::path> Folders() const;  // of committed files
  [[nodiscard]] bool Owns(const std::filesystem::path& folder) const;
  [[nodiscard]] Status CheckOutputPath(const std::string& path) const;
  [[nodiscard]] Result<std::filesystem::path> StagingOf(const std::string& staging) const;
  [[nodiscard]] Status CommitFile(const std::filesystem::path& staging, const OutputFile& file) const;

  std::filesystem::path dir_;
  OutputContent content_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_OUTPUT_FOLDER_H_
