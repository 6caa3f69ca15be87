#ifndef DEPTHFARM_COORDINATOR_CLIENT_CLIENT_H_
#define DEPTHFARM_COORDINATOR_CLIENT_CLIENT_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/estimation_params.h"
#include "common/job/task_spec.h"
#include "common/job/virtual_picture.h"
#include "common/sequence/sequence.h"
#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/wire/envelope.h"

namespace depthfarm {

// Which coordinator, and how to prove who asks.
struct CoordinatorTarget {
  std::string endpoint;   // tcp://HOST:PORT or ipc://PATH
  std::string keys_dir;   // of `depthfarm keygen`; empty: no CURVE
  bool insecure = false;  // tcp without CURVE, loopback addresses only
};

struct ClientCallOptions {
  std::chrono::milliseconds timeout{10'000};  // for one answer
  std::function<bool()> stop;                 // asked several times a second; true ends the call with kCancelled
};

// What a rendering job is handed in with.
struct RenderSubmission {
  RenderSource source;
  std::vector<VirtualPicture> views;
};

// What the submitter serves itself: the files of each camera of the sequence, in its order. Empty digests stand for
// files that the job does not read.
struct UploadSubmission {
  struct CameraFiles {
    std::vector<UploadedFile> images;
    std::vector<UploadedFile> masks;
    std::vector<UploadedFile> prior;
    std::vector<UploadedFile> prior_confidence;
  };
  ArtifactLocation from;
  std::vector<CameraFiles> cameras;
};

// A job as it is handed in. output_dir, the sequence's file and its pictures are absolute paths as every worker sees
// them. Without output_dir the job keeps its results on the workers.
struct JobSubmission {
  Sequence sequence;
  EstimationParams params;
  std::string output_dir;
  std::string name;
  int priority = 0;
  std::vector<std::string> required_tags = {};
  // Set: views are rendered; of the sequence its name and file count, of `params` nothing.
  std::optional<RenderSubmission> render = std::nullopt;
  // Set: workers fetch pictures and guides from there; GetStatus must say so every few seconds.
  std::optional<UploadSubmission> uploads = std::nullopt;
};

// The submitter's side of the protocol (proto/PROTOCOL.md): one question at a time, each matched with its answer by the
// request id; answers to questions that timed out are dropped. Not thread-safe.
//
// Errors of every call: kUnavailable exactly when no answer came in time (nobody there, or CURVE refused the key);
// kIncompatible: another protocol version; kInvalidArgument: what the coordinator says is wrong with the question, e.g.
// an unknown job or a key without the role; kCorrupt: an answer that does not fit the question.
class Client {
 public:
  // Does not wait for the coordinator. kInvalidArgument: the endpoint is none, keys that cannot be read, or tcp with
  // neither keys nor `insecure`.
  [[nodiscard]] static Result<std::unique_ptr<Client>> Connect(const CoordinatorTarget& target,
                                                               ClientCallOptions options = {});

  [[nodiscard]] Result<std::uint64_t> Submit(const JobSubmission& submission);
  // `serves_uploads`: from the submitter of a job with uploads, that it is still there.
  [[nodiscard]] Result<v1::JobStatus> GetStatus(std::uint64_t job_id, bool serves_uploads = false);
  // When the job has ended, or after `wait`, but half the timeout of calls at most; sooner where many wait.
  [[nodiscard]] Result<v1::JobStatus> AwaitStatus(std::uint64_t job_id, std::chrono::milliseconds wait);
  // What is done of a job that keeps its results, from a frame on; several questions may be needed.
  [[nodiscard]] Result<v1::Results> GetResults(std::uint64_t job_id, std::uint32_t first_frame);
  // All that the coordinator knows, in as many questions as it takes.
  [[nodiscard]] Result<std::vector<v1::JobStatus>> ListJobs();
  // Of the tasks that `task` names (GetJobLogs), of all if it is empty: the whole, in as many questions as it takes.
  [[nodiscard]] Result<v1::JobLogs> GetLogs(std::uint64_t job_id, const std::string& task);
  [[nodiscard]] Status Cancel(std::uint64_t job_id);
  // Of a job that failed or was cancelled.
  [[nodiscard]] Status Retry(std::uint64_t job_id);
  [[nodiscard]] Result<std::vector<v1::WorkerStatus>> ListWorkers();
  // Of jobs that workers with these tags may work for.
  [[nodiscard]] Result<v1::Backlog> GetBacklog(const std::vector<std::string>& tags);
  // By the name that ListWorkers tells.
  [[nodiscard]] Status Drain(const std::string& worker);
  [[nodiscard]] Status StopCoordinator();

 private:
  Client() = default;
  // Sends the question and returns the answer whose body is `expected`.
  [[nodiscard]] Result<v1::Envelope> Ask(v1::Envelope question, v1::Envelope::BodyCase expected);

  ClientCallOptions options_;
  std::string endpoint_;
  bool encrypted_ = false;
  std::uint64_t last_request_id_ = 0;
  TransportContext context_;
  std::unique_ptr<ClientChannel> channel_;  // after context_: must go first
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLIENT_CLIENT_H_
