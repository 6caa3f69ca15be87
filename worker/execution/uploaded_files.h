#ifndef DEPTHFARM_WORKER_EXECUTION_UPLOADED_FILES_H_
#define DEPTHFARM_WORKER_EXECUTION_UPLOADED_FILES_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/store.h"
#include "worker/execution/artifact_fetcher.h"

namespace depthfarm {

// The files of a task that its job's submitter serves, each as the input that a fetcher takes.
[[nodiscard]] std::vector<TaskInput> UploadsOf(const TaskSpec& spec);

// A file that the submitter serves: from the store, where it may have been fetched to ahead, else from the submitter,
// who is given 20 s to come back. `path` is its name there. Errors: kUnavailable: the submitter did not answer;
// kCorrupt: the file was changed since the job was submitted, or is not the one that was named; kCancelled.
[[nodiscard]] Result<std::string> ReadUpload(ArtifactStore& store, ArtifactFetcher& fetcher, const UploadedFile& file,
                                             const ArtifactLocation& from, const std::string& path,
                                             const std::stop_token& stop, std::uint64_t& fetched_bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_UPLOADED_FILES_H_
