#include "coordinator/service/coordinator.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "common/log/log.h"
#include "common/text/clean_line.h"
#include "common/transport/endpoint.h"
#include "common/transport/farm_keys.h"
#include "common/wire/bounds.h"
#include "common/wire/job_wire.h"
#include "common/wire/task_wire.h"
#include "coordinator/service/submission.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr int kMaxVersionText = 100;
constexpr std::size_t kMaxLoggedReason = 200;
constexpr std::size_t kMaxLastLine = 300;  // in the reason of a failed attempt
constexpr std::chrono::milliseconds kLongestWait{10'000};
constexpr std::size_t kMostKeptJobs = 20'000;  // who asks for no page of them gets all in one message

SchedulerOptions SchedulerOptionsOf(const CoordinatorOptions& options, std::uint64_t first_lease) {
  SchedulerOptions scheduler;
  scheduler.lease = options.lease;
  scheduler.cleanup_grace = 5 * options.lease;
  scheduler.submitter_silence = 5 * options.lease;
  scheduler.max_attempts = options.max_attempts;
  scheduler.max_setbacks = 4 * options.max_attempts;
  scheduler.first_lease = first_lease;
  scheduler.duplicates = options.duplicates;
  return scheduler;
}

bool IsFromWorker(const v1::Envelope& envelope) {
  switch (envelope.body_case()) {
    case v1::Envelope::kWorkerHello:
    case v1::Envelope::kAskForTask:
    case v1::Envelope::kHeartbeat:
    case v1::Envelope::kTaskFinished:
    case v1::Envelope::kArtifactsDropped:
    case v1::Envelope::kWorkerGoodbye:
    case v1::Envelope::kWorkerDied:
      return true;
    default:
      return false;
  }
}

// Whether a user may send the message. Without CURVE there are no users: the socket's folder or machine is the guard.
Status CheckRole(const std::string& user_id, bool has_keys, const v1::Envelope& envelope) {
  if (!has_keys) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(const Role role, RoleOfUser(user_id));
  const bool administers =
      envelope.body_case() == v1::Envelope::kStopCoordinator || envelope.body_case() == v1::Envelope::kDrainWorker;
  bool allowed = role == Role::kAdmin || (role == Role::kSubmit && !administers);
  if (IsFromWorker(envelope)) allowed = role == Role::kWork;
  if (allowed) return {};
  return InvalidArgument("a key of role " + std::string(RoleName(role)) + " may not send " + BodyName(envelope));
}

std::vector<LeaseId> LeasesFromProto(const google::protobuf::RepeatedField<std::uint64_t>& ids) {
  std::vector<LeaseId> leases;
  for (const std::uint64_t id : ids) leases.emplace_back(id);
  return leases;
}

std::vector<ArtifactKey> KeysFromProto(const google::protobuf::RepeatedPtrField<std::string>& keys) {
  std::vector<ArtifactKey> parsed;
  for (const std::string& key : keys) {
    const auto digest = DigestFromBytes("key", key);
    if (digest.ok()) parsed.push_back(*digest);
  }
  return parsed;
}

Result<TaskFinished> ResultFromProto(WorkerId worker, const TaskId& task, const v1::TaskFinished& message) {
  TaskFinished result{worker, LeaseId(message.lease_id()), task, {}, {}, {}, FromProto(message.stats())};
  if (message.has_artifact()) {
    DEPTHFARM_ASSIGN_OR_RETURN(result.artifact, FromProto(message.artifact()));
    if (!message.output_key().empty() && message.output_key() != message.artifact().key()) {
      return InvalidArgument("output key and key of the artifact differ");
    }
  }
  for (const v1::OutputFile& file : message.files()) {
    DEPTHFARM_ASSIGN_OR_RETURN(OutputFile parsed, FromProto(file));
    result.files.push_back(std::move(parsed));
  }
  if (!message.picture_digest().empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(result.picture_digest, DigestFromBytes("picture digest", message.picture_digest()));
  }
  return result;
}

}  // namespace

Status CoordinatorOptions::Validate() const {
  if (heartbeat < milliseconds(10) || heartbeat > milliseconds(60'000)) {
    return InvalidArgument("heartbeat is " + std::to_string(heartbeat.count()) + " ms, expected 10 to 60000");
  }
  if (lease < 3 * heartbeat || lease > std::chrono::hours(1)) {
    return InvalidArgument("lease is " + std::to_string(lease.count()) + " ms, expected at least 3 heartbeats (" +
                           std::to_string(3 * heartbeat.count()) + " ms) and at most an hour");
  }
  if (max_attempts < 1 || max_attempts > 100) {
    return InvalidArgument("max-attempts is " + std::to_string(max_attempts) + ", expected 1 to 100");
  }
  if (kept_jobs < 1 || kept_jobs > kMostKeptJobs) {
    return InvalidArgument("keep-jobs is " + std::to_string(kept_jobs) + ", expected 1 to " +
                           std::to_string(kMostKeptJobs));
  }
  return {};
}

Coordinator::Coordinator(const CoordinatorOptions& options, std::uint64_t first_lease, std::unique_ptr<Journal> journal,
                         bool secure)
    : options_(options),
      secure_(secure),
      scheduler_(SchedulerOptionsOf(options, first_lease)),
      history_(options.kept_jobs),
      journal_(std::move(journal)),
      last_claim_(first_lease) {}

void Coordinator::Tick(TimePoint now) {
  now_ = now;
  CarryOut(scheduler_.Tick(now_));
  AnswerThoseThatWait(status_waits_.TakeDue(now_));
}

int Coordinator::DropUnlisted(const AllowedKeys& allowed, TimePoint now) {
  now_ = now;
  std::vector<WorkerSession> dropped;
  for (const auto& [id, session] : workers_.all()) {
    const auto user = allowed.find(session.key);
    if (user == allowed.end() || RoleOfUser(user->second).value() != Role::kWork) {
      dropped.push_back(session);
    } else {
      workers_.SetUser(id, user->second);
    }
  }
  for (const WorkerSession& session : dropped) {
    // The first message tells it and its log why, the second one that asking again is of no use.
    v1::Envelope reason;
    *reason.mutable_error() = ToProto(InvalidArgument("this worker's key was taken off the farm's list of workers"));
    Send(session.peer, std::move(reason));
    v1::Envelope stop;
    stop.mutable_stop_worker();
    Send(session.peer, std::move(stop));
    workers_.Remove(session.id);
    Dispatch(WorkerLeft{session.id});
  }
  return static_cast<int>(dropped.size());
}

void Coordinator::SayGoodbye() {
  v1::Envelope stop;
  stop.mutable_stop_worker();
  for (const auto& [id, session] : workers_.all()) Send(session.peer, stop);
}

void Coordinator::Handle(const PeerMessage& message, TimePoint now) {
  now_ = now;
  const Result<v1::Envelope> envelope = ParseEnvelope(message.payload);
  if (!envelope.ok()) {
    const bool other_version = envelope.status().code() == ErrorCode::kIncompatible;
    CountRefusal(other_version ? refusals_.other_version : refusals_.malformed, message.user_id, envelope.status());
    Refuse(message, 0, envelope.status());
    return;
  }
  const Status allowed = CheckRole(message.user_id, secure_, *envelope);
  if (!allowed.ok()) {
    CountRefusal(refusals_.wrong_role, message.user_id, allowed);
    Refuse(message, envelope->request_id(), allowed);
  } else if (IsFromWorker(*envelope)) {
    HandleFromWorker(message, *envelope);
  } else {
    HandleFromClient(message, *envelope);
  }
}

void Coordinator::HandleFromWorker(const PeerMessage& message, const v1::Envelope& envelope) {
  if (envelope.has_worker_hello()) {
    HandleHello(message, envelope.worker_hello());
    return;
  }
  if (envelope.has_worker_died()) {
    HandleDied(message, envelope.worker_died());
    return;
  }
  const WorkerSession* session = workers_.FindPeer(message.peer);
  if (session == nullptr || session->user_id != message.user_id) {
    Refuse(message, envelope.request_id(), Unavailable("the coordinator does not know this worker: say hello"));
    return;
  }
  const WorkerId worker = session->id;
  switch (envelope.body_case()) {
    case v1::Envelope::kAskForTask:
      Dispatch(WorkerAsked{worker, envelope.ask_for_task().ask_id(),
                           LeasesFromProto(envelope.ask_for_task().running_leases())});
      break;
    case v1::Envelope::kHeartbeat:
      Dispatch(WorkerHeard{worker, envelope.heartbeat().heartbeat_id(),
                           LeasesFromProto(envelope.heartbeat().running_leases())});
      break;
    case v1::Envelope::kTaskFinished:
      HandleTaskFinished(worker, envelope.task_finished());
      break;
    case v1::Envelope::kArtifactsDropped:
      Dispatch(ArtifactsDropped{worker, KeysFromProto(envelope.artifacts_dropped().keys())});
      break;
    default:  // WorkerGoodbye
      Dispatch(WorkerLeft{worker});
      workers_.Remove(worker);
      break;
  }
}

void Coordinator::HandleHello(const PeerMessage& message, const v1::WorkerHello& hello) {
  const auto check = [&]() -> Result<WorkerSession> {
    DEPTHFARM_RETURN_IF_ERROR(CheckText("worker name", hello.name(), kMaxNameBytes));
    if (hello.name().empty()) return InvalidArgument("worker name is empty");
    DEPTHFARM_RETURN_IF_ERROR(CheckText("software version", hello.software_version(), kMaxVersionText));
    DEPTHFARM_RETURN_IF_ERROR(ParseEndpoint(hello.artifact_endpoint()).status().WithContext("artifact server"));
    if (hello.slots() > kMaxWorkerSlots || hello.tasks_ahead() > kMaxWorkerSlots) {
      return InvalidArgument("the worker has " + std::to_string(hello.slots()) + " slots and takes " +
                             std::to_string(hello.tasks_ahead()) + " tasks ahead, expected at most " +
                             std::to_string(kMaxWorkerSlots));
    }
    if (!hello.artifact_public_key().empty() && !IsCurveKey(hello.artifact_public_key())) {
      return InvalidArgument("the artifact server's key is no CURVE key");
    }
    return WorkerSession{WorkerId(),
                         message.peer,
                         message.key,
                         message.user_id,
                         hello.name(),
                         hello.software_version(),
                         {hello.artifact_endpoint(), hello.artifact_public_key()},
                         hello.process()};
  };
  Result<WorkerSession> session = check();
  Result<std::set<std::string>> tags = CheckTags("worker tags", {hello.tags().begin(), hello.tags().end()});
  if (!session.ok() || !tags.ok()) {
    Refuse(message, 0, session.ok() ? tags.status() : session.status());
    return;
  }
  const WorkerSession* before = workers_.FindPeer(message.peer);
  if (before != nullptr && before->name != hello.name()) Dispatch(WorkerLeft{before->id});
  const WorkerSession* same_name = workers_.FindName(hello.name());
  const bool restarted =
      same_name != nullptr && same_name->process != 0 && hello.process() != 0 && same_name->process != hello.process();
  const Result<WorkerId> id = workers_.Join(std::move(session).value());
  if (!id.ok()) {
    Refuse(message, 0, id.status());
    return;
  }
  WorkerJoined event{.worker = *id,
                     .name = hello.name(),
                     .running = LeasesFromProto(hello.running_leases()),
                     .slots = std::max(1, static_cast<int>(hello.slots())),
                     .ahead = static_cast<int>(hello.tasks_ahead()),
                     .memory_bytes = hello.memory_bytes(),
                     .tags = std::move(tags).value(),
                     .restarted = restarted,
                     .algorithm_version = hello.algorithm_version()};
  for (const v1::ArtifactInfo& artifact : hello.artifacts()) {
    const Result<ArtifactInfo> parsed = FromProto(artifact);
    if (parsed.ok()) event.artifacts.push_back(*parsed);
  }
  v1::Envelope welcome;
  welcome.mutable_worker_welcome()->set_worker_id(id->value());
  welcome.mutable_worker_welcome()->set_heartbeat_ms(static_cast<std::uint32_t>(options_.heartbeat.count()));
  welcome.mutable_worker_welcome()->set_lease_ms(static_cast<std::uint32_t>(options_.lease.count()));
  Send(message.peer, std::move(welcome));
  Dispatch(event);
}

void Coordinator::HandleDied(const PeerMessage& message, const v1::WorkerDied& died) {
  const WorkerSession* session = workers_.FindName(died.name());
  // The name may be another process's by now, and nobody may end the workers of others.
  if (session == nullptr || session->user_id != message.user_id || died.process() == 0 ||
      session->process != died.process()) {
    LogDebug("death_of_nobody", {{"user", message.user_id}, {"name", CleanLine(died.name(), kMaxNameBytes)}});
    return;
  }
  std::string how = CleanLine(died.how(), kMaxDeathBytes);
  const TaskLog last_words = FromProto(died.last_words());
  if (!last_words.lines.empty()) how += "; its last words: " + CleanLine(last_words.lines.back(), kMaxLastLine);
  Dispatch(WorkerDied{session->id, how, LeasesFromProto(died.computing()), last_words});
}

void Coordinator::HandleTaskFinished(WorkerId worker, const v1::TaskFinished& message) {
  const Result<TaskId> task = FromProto(message.task());
  if (!task.ok()) {
    CountRefusal(refusals_.malformed, "worker " + std::to_string(worker.value()), task.status());
    return;  // the lease runs out
  }
  const LeaseId lease(message.lease_id());
  const Status error = FromProto(message.error());
  attempts_.Report(worker, lease, *task, FromProto(message.stats()), FromProto(message.log()));
  if (!error.ok()) {
    Dispatch(TaskFailed{worker, lease, *task, error, KeysFromProto(message.missing_inputs())});
    return;
  }
  Result<TaskFinished> result = ResultFromProto(worker, *task, message);
  if (result.ok()) {
    Dispatch(std::move(result).value());
  } else {
    Dispatch(TaskFailed{worker, lease, *task, Internal("its result is malformed: " + result.status().message()), {}});
  }
}

bool Coordinator::Waits(const PeerMessage& message, const v1::Envelope& question) {
  const v1::GetJobStatus& asked = question.get_job_status();
  if (asked.wait_ms() == 0 || asked.serves_uploads()) return false;
  const JobId id(asked.job_id());
  const std::optional<JobSnapshot> job = scheduler_.Job(id);
  if (!job || job->state != JobState::kRunning || status_waits_.full()) return false;
  const auto wait = std::min(std::chrono::milliseconds(asked.wait_ms()), kLongestWait);
  status_waits_.Add({message.peer, question.request_id(), id}, now_ + wait);
  return true;
}

void Coordinator::AnswerThoseThatWait(const std::vector<StatusWaits::Question>& questions) {
  for (const StatusWaits::Question& question : questions) {
    Result<v1::Envelope> answer = StatusOf(question.job);
    if (!answer.ok()) continue;  // forgotten meanwhile: it will ask again, and be told so
    answer->set_request_id(question.request_id);
    Send(question.peer, std::move(answer).value());
  }
}

void Coordinator::HandleFromClient(const PeerMessage& message, const v1::Envelope& envelope) {
  if (envelope.has_get_job_status() && Waits(message, envelope)) return;
  Result<v1::Envelope> answer = Answer(envelope);
  if (!answer.ok()) {
    Refuse(message, envelope.request_id(), answer.status());
    return;
  }
  answer->set_request_id(envelope.request_id());
  Send(message.peer, std::move(answer).value());
}

Result<v1::Envelope> Coordinator::Answer(const v1::Envelope& request) {
  switch (request.body_case()) {
    case v1::Envelope::kSubmitJob:
      return Submit(request.submit_job());
    case v1::Envelope::kListJobs:
      return ListJobs(request.list_jobs());
    case v1::Envelope::kGetJobStatus:
      if (request.get_job_status().serves_uploads()) Dispatch(SubmitterHeard{JobId(request.get_job_status().job_id())});
      return StatusOf(JobId(request.get_job_status().job_id()));
    case v1::Envelope::kGetJobLogs:
      return LogsOf(request.get_job_logs());
    case v1::Envelope::kRetryJob:
      return Retry(JobId(request.retry_job().job_id()));
    case v1::Envelope::kGetResults:
      return ResultsOf(request.get_results());
    case v1::Envelope::kCancelJob:
      return Cancel(JobId(request.cancel_job().job_id()));
    case v1::Envelope::kListWorkers:
      return ListWorkers();
    case v1::Envelope::kGetBacklog:
      return BacklogOf(request.get_backlog());
    case v1::Envelope::kDrainWorker:
      return Drain(request.drain_worker().name());
    case v1::Envelope::kStopCoordinator: {
      v1::Envelope answer;
      answer.mutable_done();
      asked_to_stop_ = true;
      return answer;
    }
    default:
      return InvalidArgument("a coordinator does not take " + BodyName(request));
  }
}

Result<v1::Envelope> Coordinator::Submit(const v1::SubmitJob& request) {
  const JobId id(last_job_ + 1);
  DEPTHFARM_ASSIGN_OR_RETURN(PlannedJob job, PlanSubmission(request, id));
  if (!job.uploads.empty() && secure_ && job.uploads_from.public_key.empty() &&
      job.uploads_from.endpoint.starts_with("tcp://")) {
    return InvalidArgument("uploads: the server has no key, which this farm asks for");
  }
  const std::optional<JobId> other =
      job.config.keeps_results ? std::nullopt : scheduler_.JobWritingTo(job.config.output_dir);
  if (other) {
    return InvalidArgument("job " + std::to_string(other->value()) + " writes to " + job.config.output_dir +
                           ": wait for it, cancel it, or choose another folder");
  }
  DEPTHFARM_ASSIGN_OR_RETURN(std::set<std::string> tags, CheckTags("required tags", {request.required_tags().begin(),
                                                                                     request.required_tags().end()}));
  // Who is told the id may rely on the job.
  DEPTHFARM_RETURN_IF_ERROR(journal_->Admit({.id = id,
                                             .algorithm_version = kAlgorithmVersion,
                                             .output_dir = job.config.output_dir,
                                             .submission = request.SerializeAsString(),
                                             .state = JobState::kRunning,
                                             .status = {}}));
  ++last_job_;
  Start(std::move(job), request, std::move(tags), {}, false);
  v1::Envelope answer;
  answer.mutable_job_accepted()->set_job_id(id.value());
  return answer;
}

Result<v1::Envelope> Coordinator::Cancel(JobId id) {
  if (!scheduler_.Job(id)) {
    const bool ended = history_.Find(id) != nullptr;
    return InvalidArgument((ended ? "job " : "there is no job ") + std::to_string(id.value()) +
                           (ended ? " has ended" : ""));
  }
  const Status written = journal_->Cancel(id);
  if (!written.ok()) {  // a coordinator that is started again would let it go on; this one ends it all the same
    LogError("journal_failed", {{"job", id.value()}, {"reason", written.message()}});
  }
  Dispatch(JobCancelled{id});
  v1::Envelope answer;
  answer.mutable_done();
  return answer;
}

Result<v1::Envelope> Coordinator::Drain(const std::string& name) {
  const WorkerSession* session = workers_.FindName(name);
  if (session == nullptr) return InvalidArgument("there is no worker '" + name.substr(0, kMaxNameBytes) + "'");
  Dispatch(WorkerDrained{session->id});
  v1::Envelope answer;
  answer.mutable_done();
  return answer;
}

void Coordinator::Dispatch(const Event& event) { CarryOut(scheduler_.Handle(event, now_)); }

void Coordinator::CarryOut(const std::vector<Action>& actions) {
  for (const Action& action : actions) std::visit([this](const auto& typed) { Do(typed); }, action);
}

void Coordinator::Send(const std::string& peer, v1::Envelope envelope) {
  outgoing_.push_back({peer, std::move(envelope)});
}

void Coordinator::SendTo(WorkerId worker, v1::Envelope envelope) {
  if (const WorkerSession* session = workers_.Find(worker)) Send(session->peer, std::move(envelope));
}

void Coordinator::CountRefusal(std::uint64_t& counter, const std::string& user, const Status& reason) {
  ++counter;
  refusals_.last_user = user;
  refusals_.last_reason = reason.message().substr(0, kMaxLoggedReason);
}

void Coordinator::Refuse(const PeerMessage& message, std::uint64_t request_id, const Status& reason) {
  LogDebug("message_refused", {{"user", message.user_id}, {"reason", reason.message()}});
  v1::Envelope envelope;
  envelope.set_request_id(request_id);
  *envelope.mutable_error() = ToProto(reason);
  Send(message.peer, std::move(envelope));
}

}  // namespace depthfarm
