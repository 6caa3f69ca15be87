// submit --upload: the submitter serves the pictures itself, and stays until the job has ended.
#include <chrono>
#include <iostream>
#include <optional>

#include "common/files/writable_folder.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/fetch_session.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/progress.h"
#include "coordinator/cli/report.h"
#include "coordinator/uploading/upload.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kWatchInterval{500};
constexpr std::chrono::milliseconds kCancelTimeout{5000};
constexpr std::chrono::minutes kPatience{10};  // with a coordinator that is started again

// An interrupted client asks nothing any more: by another one.
void Cancel(const FarmArguments& farm, std::uint64_t job_id) {
  const auto client = Client::Connect(TargetOf(farm), {.timeout = kCancelTimeout, .stop = nullptr});
  const Status cancelled = client.ok() ? client.value()->Cancel(job_id) : client.status();
  if (cancelled.ok()) {
    std::cerr << "depthfarm: job " << job_id << " was cancelled\n";
  } else {
    std::cerr << "depthfarm: job " << job_id << " could not be cancelled: " << cancelled.message() << "\n";
  }
}

// What watches a job with uploads, and fetches its results where they are wanted.
class UploadedJob {
 public:
  UploadedJob(const SubmitArguments& arguments, Client& client, std::uint64_t job_id)
      : arguments_(arguments), client_(client), job_id_(job_id) {}

  // Follows the job to its end. kCancelled: interrupted; else the failure of a question, or of the folder.
  [[nodiscard]] Status Follow() {
    if (!arguments_.job.output_dir.empty()) DEPTHFARM_RETURN_IF_ERROR(OpenFolder());
    ProgressLine progress;
    auto last_answer = std::chrono::steady_clock::now();
    while (true) {
      const Status round = Round();
      if (round.code() == ErrorCode::kUnavailable && !folder_failed() &&
          std::chrono::steady_clock::now() - last_answer < kPatience) {
        progress.Show("job " + std::to_string(job_id_) + ": the coordinator does not answer; waiting for it");
        PauseUnlessInterrupted(kWatchInterval);
        if (Interrupted()) return Cancelled();
        continue;
      }
      DEPTHFARM_RETURN_IF_ERROR(round);
      last_answer = std::chrono::steady_clock::now();
      progress.Show("job " + std::to_string(job_id_) + ": " + FormatProgress(status_));
      // With the last round after the job has ended.
      if (status_.state() != v1::JOB_STATE_RUNNING) return {};
      PauseUnlessInterrupted(kWatchInterval);
      if (Interrupted()) return Cancelled();
    }
  }
  [[nodiscard]] bool folder_failed() const { return fetch_ && fetch_->folder_failed(); }

  [[nodiscard]] int Report() const {
    if (arguments_.json) {
      nlohmann::ordered_json json = JobToJson(status_);
      if (fetch_) json["fetch"] = FetchToJson(*fetch_, job_id_, arguments_.job.output_dir);
      std::cout << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    } else {
      std::cout << FormatJob(status_, BegunAnewBy::kSameCommand);
      if (fetch_) std::cout << FormatFetch(*fetch_, job_id_, arguments_.job.output_dir);
    }
    const int code = ExitCodeOfJob(status_);
    return code == kExitOk && fetch_ && !fetch_->complete() ? kExitFailed : code;
  }

 private:
  Status Round() {
    DEPTHFARM_ASSIGN_OR_RETURN(status_, client_.GetStatus(job_id_));
    return fetch_ ? fetch_->Round(stop_.token(), [] {}) : Status();
  }
  Status OpenFolder() {
    DEPTHFARM_ASSIGN_OR_RETURN(peers_, PeersOf(arguments_.farm, context_));
    DEPTHFARM_ASSIGN_OR_RETURN(fetch_, ResultFetch::Open(client_, *peers_, job_id_, arguments_.job.output_dir));
    return {};
  }

  const SubmitArguments& arguments_;
  Client& client_;
  const std::uint64_t job_id_;
  v1::JobStatus status_;
  const StopOnInterruption stop_;
  TransportContext context_;
  std::unique_ptr<ArtifactClient> peers_;
  std::unique_ptr<ResultFetch> fetch_;
};

}  // namespace

int SubmitWithUploads(const SubmitArguments& arguments) {
  Result<JobRequest> request = ReadJobRequest(arguments.job);
  if (!request.ok()) return Fail(request.status());
  if (!arguments.job.output_dir.empty()) {
    const Status writable = CheckWritableFolder(arguments.job.output_dir);
    if (!writable.ok()) return Fail(writable);
  }
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  std::cerr << DescribeJob(request->resolved) << "\n";
  ProgressLine progress;
  const Result<std::unique_ptr<Upload>> upload =
      Upload::Start(TargetOf(arguments.farm), {.listen = arguments.upload_listen, .advertise = arguments.upload_host},
                    request->sequence, request->resolved, [&](std::size_t read, std::size_t all) {
                      progress.Show("read " + std::to_string(read) + " of " + std::to_string(all) + " files");
                      return Interrupted();
                    });
  progress.Finish();
  if (!upload.ok()) return Fail(upload.status());
  const UploadSubmission& uploads = upload.value()->submission();
  const std::string name = arguments.name.empty() ? request->sequence.name : arguments.name;
  const Result<std::uint64_t> job_id = client.value()->Submit({.sequence = std::move(request->sequence),
                                                               .params = request->params,
                                                               .output_dir = "",
                                                               .name = name,
                                                               .priority = arguments.priority,
                                                               .required_tags = arguments.required_tags,
                                                               .render = std::nullopt,
                                                               .uploads = uploads});
  if (!job_id.ok()) return FailAsking(job_id.status());
  std::cerr << "job " << *job_id << ": serving its files at " << uploads.from.endpoint << "\n";
  Status followed = upload.value()->KeepAlive(TargetOf(arguments.farm), *job_id);
  UploadedJob job(arguments, *client.value(), *job_id);
  if (followed.ok()) followed = job.Follow();
  if (followed.ok()) return job.Report();
  // Without this process nobody serves the pictures: the job can't go on.
  Cancel(arguments.farm, *job_id);
  if (Interrupted()) return kExitInterrupted;
  return job.folder_failed() ? Fail(followed) : FailAsking(followed);
}

}  // namespace depthfarm
