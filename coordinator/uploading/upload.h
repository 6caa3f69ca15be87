#ifndef DEPTHFARM_COORDINATOR_UPLOADING_UPLOAD_H_
#define DEPTHFARM_COORDINATOR_UPLOADING_UPLOAD_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "common/base/status.h"
#include "common/job/resolved_job.h"
#include "common/sequence/sequence.h"
#include "common/transport/context.h"
#include "coordinator/client/client.h"
#include "worker/transfer/artifact_server.h"
#include "worker/transfer/served_files.h"

namespace depthfarm {

struct UploadOptions {
  std::string listen;     // endpoint; empty: beside the coordinator's ipc socket, else a free tcp port
  std::string advertise;  // host name or address that workers reach this one by; empty: its name
};

// Serves the pictures, masks and priors of a job from their files to the workers of a farm, as long as it lives: over
// the artifact protocol, and with CURVE to keys of role work alone. Memory does not grow with what is served.
class Upload {
 public:
  // Told after each file, how many of all were read; true ends the reading.
  using OnFile = std::function<bool(std::size_t read, std::size_t all)>;

  // Reads every file of the job's views and frames once, for its digest, then serves. Errors: kInvalidArgument:
  // endpoints, keys, security rules, a file that cannot be served; kUnavailable: a file or an address; kCancelled.
  [[nodiscard]] static Result<std::unique_ptr<Upload>> Start(const CoordinatorTarget& farm,
                                                             const UploadOptions& options, const Sequence& sequence,
                                                             const ResolvedJob& job, const OnFile& on_file);
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;
  ~Upload() = default;

  [[nodiscard]] const UploadSubmission& submission() const { return submission_; }
  // From now on tells the coordinator every second, on a connection of its own, that the submitter is there.
  [[nodiscard]] Status KeepAlive(const CoordinatorTarget& farm, std::uint64_t job_id);

 private:
  Upload() = default;
  [[nodiscard]] Status AddFiles(const Sequence& sequence, const ResolvedJob& job, const OnFile& on_file);
  [[nodiscard]] Status Serve(const CoordinatorTarget& farm, const UploadOptions& options);

  ServedFiles files_;
  UploadSubmission submission_;
  TransportContext context_;
  std::unique_ptr<ArtifactServer> server_;  // after context_ and files_: goes first
  std::jthread keeper_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_UPLOADING_UPLOAD_H_
