#include "tests/simulation/submitter.h"

#include <utility>

#include "common/wire/task_wire.h"

namespace depthfarm::simulation {
namespace {

constexpr Milliseconds kPatience{5000};
constexpr Milliseconds kPoll{2000};

}  // namespace

Submitter::Submitter(std::string name, std::string folder, std::vector<Wish> wishes, EventQueue& events,
                     std::function<void(std::string)> send, std::function<void(const JobEnd&)> ended)
    : name_(std::move(name)),
      folder_(std::move(folder)),
      wishes_(std::move(wishes)),
      events_(events),
      send_(std::move(send)),
      on_end_(std::move(ended)) {}

void Submitter::Start(Milliseconds pause) { AskAfter(pause); }

void Submitter::AskAfter(Milliseconds pause) {
  events_.After(pause, [this, request = request_] {
    if (request == request_ && !done()) Ask();
  });
}

void Submitter::Ask() {
  v1::Envelope envelope;
  envelope.set_request_id(++request_);
  switch (step_) {
    case Step::kSubmit: {
      v1::SubmitJob& submission = *envelope.mutable_submit_job();
      submission = Submission(wish().kind, JobName(), FolderOf(wish().kind));
      submission.set_priority(wish().priority);
      for (const std::string& tag : wish().tags) submission.add_required_tags(tag);
      step_ = Step::kFind;  // unless it is answered
      break;
    }
    case Step::kFind:
      envelope.mutable_list_jobs();
      break;
    case Step::kWatch:
      envelope.mutable_get_job_status()->set_job_id(job_);
      break;
    case Step::kCancel:
      envelope.mutable_cancel_job()->set_job_id(job_);
      break;
    case Step::kRetry:
      envelope.mutable_retry_job()->set_job_id(job_);
      break;
  }
  send_(SerializeEnvelope(std::move(envelope)));
  AskAfter(kPatience);
}

void Submitter::Receive(const std::string& payload) {
  const Result<v1::Envelope> parsed = ParseEnvelope(payload);
  if (!parsed.ok() || parsed->request_id() != request_ || done()) return;
  const v1::Envelope& answer = *parsed;
  ++request_;  // answered: its repetition is off
  if (answer.has_job_accepted()) {
    Watch(answer.job_accepted().job_id());
  } else if (answer.has_job_list()) {
    // Was it admitted? A coordinator may have ended before it could say so.
    step_ = Step::kSubmit;
    for (const v1::JobStatus& job : answer.job_list().jobs()) {
      if (job.name() != JobName()) continue;
      Watch(job.job_id());
    }
  } else if (answer.has_job_status()) {
    OnStatus(answer.job_status());
    if (done()) return;
  } else if (answer.has_done()) {
    cancelled_ = true;
    step_ = Step::kWatch;
  } else if (step_ != Step::kFind) {  // there is nothing to cancel or retry
    step_ = Step::kWatch;
  }  // else the submission was refused: maybe since an earlier one of it was admitted
  AskAfter(step_ == Step::kWatch ? kPoll : Milliseconds(500));
}

void Submitter::Watch(std::uint64_t job) {
  job_ = job;
  step_ = Step::kWatch;
  cancel_at_.reset();
  if (wish().cancel_after && !retried_) cancel_at_ = events_.now() + *wish().cancel_after;
}

void Submitter::OnStatus(const v1::JobStatus& status) {
  if (status.state() == v1::JOB_STATE_RUNNING) {
    if (cancel_at_ && *cancel_at_ <= events_.now()) {
      cancel_at_.reset();
      step_ = Step::kCancel;
    }
    return;
  }
  if (status.state() != v1::JOB_STATE_DONE && wish().retries && !retried_) {
    retried_ = true;
    step_ = Step::kRetry;
    return;
  }
  JobEnd end{wish(), job_, retried_, cancelled_, status};
  on_end_(end);
  ends_.push_back(std::move(end));
  step_ = Step::kSubmit;
  retried_ = cancelled_ = false;
}

}  // namespace depthfarm::simulation
