// How the coordinator carries out what the scheduler decides.
#include <cstddef>
#include <utility>
#include <vector>

#include "common/log/log.h"
#include "common/wire/task_wire.h"
#include "coordinator/service/coordinator.h"
#include "coordinator/service/status_wire.h"

namespace depthfarm {

void Coordinator::Do(const Grant& action) {
  v1::Envelope envelope;
  v1::GrantTask* grant = envelope.mutable_grant_task();
  grant->set_lease_id(action.lease.value());
  grant->set_ask_id(action.ask_id);
  grant->set_attempt(static_cast<std::uint32_t>(action.attempt));
  TaskSpec spec = action.task.spec;
  for (std::size_t i = 0; i < spec.inputs.size(); ++i) {
    for (const WorkerId holder : action.task.holders[i]) {
      if (const WorkerSession* session = workers_.Find(holder)) spec.inputs[i].locations.push_back(session->artifacts);
    }
  }
  for (const WorkerId holder : action.task.holders_of_known) {
    if (const WorkerSession* session = workers_.Find(holder)) spec.known->locations.push_back(session->artifacts);
  }
  *grant->mutable_task() = ToProto(spec);
  const v1::JobConfig& config = jobs_.at(spec.id.job).config;
  grant->set_claim(config.claim());
  if (action.first_of_job) *grant->mutable_job() = config;
  SendTo(action.worker, std::move(envelope));
  const WorkerSession* worker = workers_.Find(action.worker);
  attempts_.Begin(action.lease, {.task = spec.id,
                                 .worker = action.worker,
                                 .worker_name = worker == nullptr ? "" : worker->name,
                                 .attempt = action.attempt,
                                 .duplicate = action.duplicate,
                                 .started = now_,
                                 .ended = {},
                                 .outcome = AttemptOutcome::kRunning,
                                 .error = {},
                                 .stats = {},
                                 .log = {}});
}

void Coordinator::Do(const AcknowledgeHeartbeat& action) {
  v1::Envelope envelope;
  v1::HeartbeatAck* ack = envelope.mutable_heartbeat_ack();
  ack->set_heartbeat_id(action.heartbeat_id);
  for (const LeaseId lease : action.unknown) ack->add_unknown_leases(lease.value());
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const Revoke& action) {
  v1::Envelope envelope;
  envelope.mutable_revoke_lease()->set_lease_id(action.lease.value());
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const AskBack& action) {
  v1::Envelope envelope;
  envelope.mutable_give_back_task()->set_lease_id(action.lease.value());
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const Release& action) {
  v1::Envelope envelope;
  for (const ArtifactKey& key : action.keys) envelope.mutable_release_artifacts()->add_keys(DigestBytes(key));
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const Keep& action) {
  v1::Envelope envelope;
  for (const ArtifactKey& key : action.keys) envelope.mutable_keep_artifacts()->add_keys(DigestBytes(key));
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const ForgetJob& action) {
  v1::Envelope envelope;
  envelope.mutable_job_ended()->set_job_id(action.job.value());
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const FrameCommitted& action) {
  const Status written = journal_->Commit(action.job, action.frame, action.committed);
  if (!written.ok()) {  // should the coordinator end, the frame is done once more
    LogWarning("journal_failed", {{"job", action.job.value()}, {"frame", action.frame}, {"reason", written.message()}});
  }
}

void Coordinator::Do(const FrameLost& action) {
  const Status written = journal_->Forget(action.job, action.frame);
  if (!written.ok()) {
    LogWarning("journal_failed", {{"job", action.job.value()}, {"frame", action.frame}, {"reason", written.message()}});
  }
}

void Coordinator::Do(const JobEnded& action) {
  const JobSnapshot& job = action.job;
  const char* state = job.state == JobState::kDone ? "done" : job.state == JobState::kFailed ? "failed" : "cancelled";
  ++jobs_ended_[state];
  LogInfo("job_ended",
          {{"job", job.id.value()}, {"state", state}, {"frames", job.frames_done}, {"retries", job.retries}});
  const v1::JobStatus status = FullStatus(job);
  const Status written = journal_->End(job.id, job.state, status.SerializeAsString(), job.keeps_results);
  if (!written.ok()) LogError("journal_failed", {{"job", job.id.value()}, {"reason", written.message()}});
  history_.Add(status);
  if (job.keeps_results) kept_configs_[job.id] = std::move(jobs_.at(job.id).config);
  jobs_.erase(job.id);
  const auto is_known = [this](JobId id) { return jobs_.contains(id) || history_.Find(id) != nullptr; };
  attempts_.KeepJobs(is_known);
  std::erase_if(submitted_, [&](const auto& entry) { return !is_known(entry.first); });
  std::vector<JobId> forgotten;
  std::erase_if(kept_configs_, [&](const auto& entry) {
    if (is_known(entry.first)) return false;
    forgotten.push_back(entry.first);
    return true;
  });
  for (const JobId id : forgotten) Dispatch(JobForgotten{id});
  AnswerThoseThatWait(status_waits_.TakeOf(job.id));
}

void Coordinator::Do(const AttemptEnded& action) { Count(action, attempts_.End(action, now_)); }

void Coordinator::Do(const WorkerLost& action) { workers_.Remove(action.worker); }

void Coordinator::Do(const EndWorker& action) {
  v1::Envelope envelope;
  envelope.mutable_stop_worker();
  SendTo(action.worker, std::move(envelope));
}

void Coordinator::Do(const Note& action) {
  if (!note_pace_.Admit(action.event, now_)) return;
  std::vector<LogField> fields;
  for (const auto& [key, value] : action.fields) fields.emplace_back(key, value);
  switch (action.severity) {
    case Note::Severity::kInfo:
      Log(LogLevel::kInfo, action.event, fields);
      break;
    case Note::Severity::kWarning:
      Log(LogLevel::kWarning, action.event, fields);
      break;
    case Note::Severity::kError:
      Log(LogLevel::kError, action.event, fields);
      break;
  }
}

void Coordinator::LogLeftOut(std::optional<TimePoint> now) {
  for (const NotePace::LeftOut& left_out : note_pace_.TakeLeftOut(now))
    LogWarning("notes_left_out", {{"event", left_out.event}, {"count", left_out.count}});
}

}  // namespace depthfarm
