#ifndef DEPTHFARM_WORKER_EXECUTION_OUTPUT_FOLDER_H_
#define DEPTHFARM_WORKER_EXECUTION_OUTPUT_FOLDER_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/execution/lease_term.h"

namespace depthfarm {

// What a job makes.
enum class OutputContent {
  kDepth,  // DIR/depth, DIR/confidence, DIR/depth.json
  kViews,  // DIR/views, DIR/views.json
};

// Who writes: a run of a job, in the person of a worker that has a lease of one of its tasks.
struct FolderClaim {
  std::uint64_t run = 0;  // JobConfig::claim; 0: of a coordinator that does not tell runs apart
  StillLeased still_leased = {};
};

// The folder of a job's result, DIR, and the only code that writes into it:
//
//   DIR/.depthfarm-job              marker: which run of a job owns the folder (DIR/.depthfarm-views-job)
//   DIR/.depthfarm-staging/<name>/  files of one attempt of Emit or Render
//   DIR/depth/<camera>/<frame>.png  committed files; DIR/confidence/<camera>/<frame>.png, DIR/views/<number>.png
//   DIR/depth.json, DIR/views.json  last of all
//   DIR/.depthfarm-removed-*        what is being removed
//
// A worker that stood still may go on in the middle of a task that was given to others, or whose job ended long ago.
// So each step that others could notice comes right after a look at the lease and at the marker, and is one call to the
// system: folders are renamed before they are removed.
//
// Files are named relative to DIR. Every path from a task is checked to be plain names below these. Every function may
// be called again after a worker died in the middle of it. Errors: kInvalidArgument for paths and foreign folders, else
// kUnavailable; all name the path.
class OutputFolder {
 public:
  // Touches nothing. kInvalidArgument unless `dir` is absolute and without "..".
  [[nodiscard]] static Result<OutputFolder> At(const std::string& dir, OutputContent content = OutputContent::kDepth,
                                               FolderClaim claim = {});

  // All below fail with kLeaseExpired when the lease is over; Stage, Commit and Finish with kUnavailable when another
  // run has the folder.

  // Makes the folder ready for a run: an older result of the same content is removed. Does nothing when it was made
  // ready for this run before. kInvalidArgument when one of the
  // folders of such a result exists but nothing says that depthfarm made it: no marker, and no manifest that names
  // files there.
  [[nodiscard]] Status Prepare() const;
  // Makes the folder ready for a run that goes on from an earlier one: these files of it must be there. Sizes are
  // checked of all and contents of some, so that another job's files are found out. kInvalidArgument names the first
  // one that is not as it should.
  [[nodiscard]] Status Resume(const std::vector<OutputFile>& files) const;
  // Writes a file of an attempt, in whole or not at all. kUnavailable when the folder belongs to no job (any more).
  [[nodiscard]] Status Stage(const std::string& staging, const std::string& path, std::string_view bytes) const;
  // Renames an attempt's files into place and removes its folder. kCorrupt when a file is not what its digest says,
  // kUnavailable when it is in neither place.
  [[nodiscard]] Status Commit(const std::string& staging, const std::vector<OutputFile>& files) const;
  // Writes depth.json or views.json, of which this is the text, and gives the folder up. Ok when that was done before.
  [[nodiscard]] Status Finish(std::string_view manifest) const;
  // Removes all attempts, also those of an earlier run of the job. The marker stays: the next job may take the folder
  // over.
  [[nodiscard]] Status RemoveStaging() const;

 private:
  OutputFolder(std::filesystem::path dir, OutputContent content, FolderClaim claim)
      : dir_(std::move(dir)), content_(content), claim_(std::move(claim)) {}
  [[nodiscard]] std::filesystem::path Manifest() const;
  [[nodiscard]] std::filesystem::path Marker() const;
  [[nodiscard]] std::vector<std::filesystem::path> Folders() const;  // of committed files
  [[nodiscard]] bool Owns(const std::filesystem::path& folder) const;
  enum class Owner { kNobody, kOther, kOursUnready, kOurs };
  [[nodiscard]] Result<Owner> ReadMarker() const;
  [[nodiscard]] Status WriteMarker(bool ready) const;
  [[nodiscard]] Status CheckLease() const;
  // That the lease is not over and the folder is this run's.
  [[nodiscard]] Status CheckOurs() const;
  // A folder or file, at once for whoever looks; nothing when it is not there.
  [[nodiscard]] Status Remove(const std::filesystem::path& path) const;
  void RemoveLeftovers() const;
  [[nodiscard]] Status CheckOutputPath(const std::string& path) const;
  [[nodiscard]] Result<std::filesystem::path> StagingOf(const std::string& staging) const;
  [[nodiscard]] Status CommitFile(const std::filesystem::path& staging, const OutputFile& file) const;

  std::filesystem::path dir_;
  OutputContent content_;
  FolderClaim claim_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_OUTPUT_FOLDER_H_
