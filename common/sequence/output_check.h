#ifndef DEPTHFARM_COMMON_SEQUENCE_OUTPUT_CHECK_H_
#define DEPTHFARM_COMMON_SEQUENCE_OUTPUT_CHECK_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// What an output folder holds against what its manifests, depth.json and views.json, say. Paths are relative to it.
struct OutputCheck {
  std::vector<std::string> manifests;  // those that are there
  std::uint64_t files = 0;             // that they name
  std::uint64_t bytes = 0;             // of those that are right
  std::vector<std::string> missing;
  std::vector<std::string> unreadable;  // there, but no file, too large, or the system does not let it be read
  std::vector<std::string> changed;     // another digest
  std::vector<std::string> unlisted;    // files of an older or other job, in the manifests' folders
  bool unfinished = false;              // a job owns the folder: it runs, or ended without finishing

  [[nodiscard]] bool good() const {
    return missing.empty() && unreadable.empty() && changed.empty() && unlisted.empty() && !unfinished;
  }
};

// Reads every file that the manifests of `directory` name and compares its SHA-256. `stop` is asked before each file.
// Lists are sorted. Errors: kInvalidArgument: no such folder, no manifest (no job finished there), or one that cannot
// be read; kCancelled.
[[nodiscard]] Result<OutputCheck> CheckOutput(const std::string& directory, const std::function<bool()>& stop);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_OUTPUT_CHECK_H_
