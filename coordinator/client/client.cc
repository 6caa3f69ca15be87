#include "coordinator/client/client.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/transport/endpoint.h"
#include "common/transport/farm_keys.h"
#include "common/wire/job_wire.h"
#include "common/wire/render_wire.h"
#include "common/wire/sequence_wire.h"
#include "common/wire/task_wire.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

// How often a waiting call looks whether it should stop.
constexpr milliseconds kLookInterval{100};
constexpr std::uint32_t kJobsOfPage = 500;

template <typename Messages>
auto ToVector(const Messages& messages) {
  return std::vector(messages.begin(), messages.end());
}

void AddFiles(const std::vector<UploadedFile>& files, google::protobuf::RepeatedPtrField<v1::UploadedFile>& protos) {
  for (const UploadedFile& upload : files) {
    v1::UploadedFile& proto = *protos.Add();
    if (upload.file.bytes > 0) proto = ToProto(upload);
  }
}

void AddUploads(const UploadSubmission& uploads, v1::SubmitJob& submit) {
  *submit.mutable_uploads_from() = ToProto(uploads.from);
  const int cameras = std::min(submit.sequence().cameras_size(), static_cast<int>(uploads.cameras.size()));
  for (int camera = 0; camera < cameras; ++camera) {
    const UploadSubmission::CameraFiles& files = uploads.cameras[static_cast<std::size_t>(camera)];
    v1::UploadedFiles& proto = *submit.mutable_sequence()->mutable_cameras(camera)->mutable_uploads();
    AddFiles(files.images, *proto.mutable_images());
    AddFiles(files.masks, *proto.mutable_masks());
    AddFiles(files.prior, *proto.mutable_prior());
    AddFiles(files.prior_confidence, *proto.mutable_prior_confidence());
  }
}

}  // namespace

Result<std::unique_ptr<Client>> Client::Connect(const CoordinatorTarget& target, ClientCallOptions options) {
  Result<Endpoint> endpoint = ParseEndpoint(target.endpoint);
  if (!endpoint.ok()) return endpoint.status().WithContext("coordinator");
  const bool encrypted = endpoint->kind == Endpoint::Kind::kTcp && !target.keys_dir.empty();
  DEPTHFARM_RETURN_IF_ERROR(CheckSecurity(*endpoint, encrypted, target.insecure));
  // No linger: a question that was not answered in time must not be asked after its asker gave up.
  ClientOptions channel_options = {.curve_server_public_key = "", .curve_own = {}, .linger = milliseconds(0)};
  if (encrypted) {
    DEPTHFARM_ASSIGN_OR_RETURN(ClientKeys keys, ReadClientKeys(target.keys_dir));
    channel_options.curve_server_public_key = keys.coordinator_public_key;
    channel_options.curve_own = keys.own;
  }
  std::unique_ptr<Client> client(new Client());
  client->options_ = std::move(options);
  client->endpoint_ = target.endpoint;
  client->encrypted_ = encrypted;
  DEPTHFARM_ASSIGN_OR_RETURN(client->channel_,
                             ClientChannel::Connect(client->context_, target.endpoint, channel_options));
  return client;
}

Result<v1::Envelope> Client::Ask(v1::Envelope question, v1::Envelope::BodyCase expected) {
  const std::uint64_t request_id = ++last_request_id_;
  question.set_request_id(request_id);
  const std::string question_name = BodyName(question);
  DEPTHFARM_RETURN_IF_ERROR(channel_->Send(SerializeEnvelope(std::move(question))));
  const auto deadline = SteadyClock::now() + options_.timeout;
  while (true) {
    // What has come counts all the same, as the last words of a coordinator that was told to stop.
    const bool stop = options_.stop && options_.stop();
    const auto left = std::chrono::ceil<milliseconds>(deadline - SteadyClock::now());
    if (!stop && left <= milliseconds(0)) break;
    DEPTHFARM_ASSIGN_OR_RETURN(std::optional<std::string> bytes,
                               channel_->Receive(stop ? milliseconds(0) : std::min(left, kLookInterval)));
    if (!bytes && stop) return Cancelled();
    if (!bytes) continue;
    DEPTHFARM_ASSIGN_OR_RETURN(v1::Envelope answer, ParseEnvelope(*bytes));
    if (answer.request_id() != request_id) continue;
    if (answer.has_error()) {
      const Status error = FromProto(answer.error());
      if (error.code() != ErrorCode::kUnavailable) return error;
      return Internal(error.message());  // somebody did answer
    }
    if (answer.body_case() == expected) return answer;
    return Corrupt("coordinator " + endpoint_ + " answered " + question_name + " with " + BodyName(answer));
  }
  return Unavailable("no answer from coordinator " + endpoint_ + " within " + std::to_string(options_.timeout.count()) +
                     " ms; is the address right and depthfarm-coordinator " +
                     (encrypted_ ? "running, and is this key in its 'authorized'?" : "running, without keys?"));
}

Result<std::uint64_t> Client::Submit(const JobSubmission& submission) {
  v1::Envelope question;
  v1::SubmitJob& submit = *question.mutable_submit_job();
  if (submission.render) {
    submit.mutable_sequence()->set_name(submission.sequence.name);
    submit.mutable_sequence()->set_file(submission.sequence.file);
    *submit.mutable_render()->mutable_source() = ToProto(submission.render->source);
    for (const VirtualPicture& view : submission.render->views) *submit.mutable_render()->add_views() = ToProto(view);
  } else {
    *submit.mutable_sequence() = ToProto(submission.sequence);
    *submit.mutable_params() = ToProto(submission.params);
  }
  if (submission.uploads) AddUploads(*submission.uploads, submit);
  submit.set_output_dir(submission.output_dir);
  submit.set_keeps_results(submission.output_dir.empty());
  submit.set_name(submission.name);
  submit.set_priority(submission.priority);
  for (const std::string& tag : submission.required_tags) submit.add_required_tags(tag);
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope answer, Ask(std::move(question), v1::Envelope::kJobAccepted));
  return answer.job_accepted().job_id();
}

Result<v1::JobStatus> Client::GetStatus(std::uint64_t job_id, bool serves_uploads) {
  v1::Envelope question;
  question.mutable_get_job_status()->set_serves_uploads(serves_uploads);
  question.mutable_get_job_status()->set_job_id(job_id);
  DEPTHFARM_ASSIGN_OR_RETURN(v1::Envelope answer, Ask(std::move(question), v1::Envelope::kJobStatus));
  return std::move(*answer.mutable_job_status());
}

Result<v1::JobStatus> Client::AwaitStatus(std::uint64_t job_id, milliseconds wait) {
  v1::Envelope question;
  question.mutable_get_job_status()->set_job_id(job_id);
  wait = std::min(wait, options_.timeout / 2);
  question.mutable_get_job_status()->set_wait_ms(static_cast<std::uint32_t>(std::max(wait, milliseconds(1)).count()));
  DEPTHFARM_ASSIGN_OR_RETURN(v1::Envelope answer, Ask(std::move(question), v1::Envelope::kJobStatus));
  return std::move(*answer.mutable_job_status());
}

Result<v1::Results> Client::GetResults(std::uint64_t job_id, std::uint32_t first_frame) {
  v1::Envelope question;
  question.mutable_get_results()->set_job_id(job_id);
  question.mutable_get_results()->set_first_frame(first_frame);
  DEPTHFARM_ASSIGN_OR_RETURN(v1::Envelope answer, Ask(std::move(question), v1::Envelope::kResults));
  return std::move(*answer.mutable_results());
}

Result<std::vector<v1::JobStatus>> Client::ListJobs() {
  std::vector<v1::JobStatus> jobs;
  std::uint64_t after = 0;
  while (true) {
    v1::Envelope question;
    question.mutable_list_jobs()->set_max_jobs(kJobsOfPage);
    question.mutable_list_jobs()->set_after(after);
    DEPTHFARM_ASSIGN_OR_RETURN(v1::Envelope answer, Ask(std::move(question), v1::Envelope::kJobList));
    for (v1::JobStatus& job : *answer.mutable_job_list()->mutable_jobs()) jobs.push_back(std::move(job));
    const std::uint64_t next = answer.job_list().next();
    if (next == 0) return jobs;
    if (next <= after) return Corrupt("coordinator " + endpoint_ + " answered with the same jobs again");
    after = next;
  }
}

Result<v1::JobLogs> Client::GetLogs(std::uint64_t job_id, const std::string& task) {
  v1::JobLogs logs;
  std::uint64_t after = 0;
  while (true) {
    v1::Envelope question;
    v1::GetJobLogs& ask = *question.mutable_get_job_logs();
    ask.set_job_id(job_id);
    ask.set_task(task);
    ask.set_after(after);
    DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope answer, Ask(std::move(question), v1::Envelope::kJobLogs));
    logs.MergeFrom(answer.job_logs());
    logs.set_next(0);
    const std::uint64_t next = answer.job_logs().next();
    if (next == 0) return logs;
    if (next <= after) return Corrupt("coordinator " + endpoint_ + " answered with the same logs again");
    after = next;
  }
}

Status Client::Cancel(std::uint64_t job_id) {
  v1::Envelope question;
  question.mutable_cancel_job()->set_job_id(job_id);
  return Ask(std::move(question), v1::Envelope::kDone).status();
}

Status Client::Retry(std::uint64_t job_id) {
  v1::Envelope question;
  question.mutable_retry_job()->set_job_id(job_id);
  return Ask(std::move(question), v1::Envelope::kJobAccepted).status();
}

Result<std::vector<v1::WorkerStatus>> Client::ListWorkers() {
  v1::Envelope question;
  question.mutable_list_workers();
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope answer, Ask(std::move(question), v1::Envelope::kWorkerList));
  return ToVector(answer.worker_list().workers());
}

Result<v1::Backlog> Client::GetBacklog(const std::vector<std::string>& tags) {
  v1::Envelope question;
  question.mutable_get_backlog()->mutable_tags()->Assign(tags.begin(), tags.end());
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope answer, Ask(std::move(question), v1::Envelope::kBacklog));
  return answer.backlog();
}

Status Client::Drain(const std::string& worker) {
  v1::Envelope question;
  question.mutable_drain_worker()->set_name(worker);
  return Ask(std::move(question), v1::Envelope::kDone).status();
}

Status Client::StopCoordinator() {
  v1::Envelope question;
  question.mutable_stop_coordinator();
  return Ask(std::move(question), v1::Envelope::kDone).status();
}

}  // namespace depthfarm
