#include "worker/execution/uploaded_files.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "common/digest/sha256.h"
#include "worker/execution/fetch_once.h"

namespace depthfarm {
namespace {

constexpr std::chrono::seconds kPatience{20};
constexpr std::chrono::milliseconds kPause{200};

TaskInput InputOf(const UploadedFile& upload, const ArtifactLocation& from) {
  return {.artifact = {.key = upload.file.sha256,
                       .stored_bytes = upload.file.bytes,
                       .content_digest = upload.artifact_digest},
          .role = InputRole::kAnalysis,
          .view = 0,
          .locations = {from}};
}

// The digest of the artifact tells that this is what the submitter serves. Results are named by that of the file: what
// another file has made must never be found under it.
Result<std::string> Checked(std::string bytes, const UploadedFile& upload, const std::string& path) {
  if (Sha256(bytes) == upload.file.sha256) return bytes;
  return Corrupt(path + ", which the job's submitter serves: its SHA-256 is not what the submitter said");
}

}  // namespace

std::vector<TaskInput> UploadsOf(const TaskSpec& spec) {
  std::vector<TaskInput> inputs;
  if (!spec.uploads) return inputs;
  const SourceDigests& files = spec.uploads->files;
  for (const std::optional<UploadedFile>& file :
       {std::optional(files.picture), files.mask, files.prior, files.prior_confidence}) {
    if (file) inputs.push_back(InputOf(*file, spec.uploads->from));
  }
  return inputs;
}

Result<std::string> ReadUpload(ArtifactStore& store, ArtifactFetcher& fetcher, const UploadedFile& file,
                               const ArtifactLocation& from, const std::string& path, const std::stop_token& stop,
                               std::uint64_t& fetched_bytes) {
  const TaskInput input = InputOf(file, from);
  if (store.Find(input.artifact.key) == input.artifact) {
    Result<std::string> bytes = store.Get(input.artifact.key);
    if (bytes.ok()) return Checked(std::move(*bytes), file, path);
  }
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    Result<Fetched> fetched = FetchOnce(store, fetcher, input, stop);
    if (fetched.ok()) {
      fetched_bytes += fetched->fetched_bytes;
      return Checked(std::move(fetched->artifact), file, path);
    }
    const Status& error = fetched.status();
    if (error.code() == ErrorCode::kCancelled) return error;
    if (error.code() == ErrorCode::kCorrupt || std::chrono::steady_clock::now() >= deadline)
      return error.WithContext(path + ", which the job's submitter serves");
    std::this_thread::sleep_for(kPause);
    if (stop.stop_requested()) return Cancelled();
  }
}

}  // namespace depthfarm
