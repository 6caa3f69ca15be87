// Jobs that outlive the coordinator, or their own failure.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/log/log.h"
#include "common/wire/bounds.h"
#include "common/wire/job_wire.h"
#include "coordinator/service/coordinator.h"
#include "coordinator/service/status_wire.h"
#include "coordinator/service/submission.h"

namespace depthfarm {
namespace {

std::string Name(JobId id) { return "job " + std::to_string(id.value()); }

// Whether what is remembered of a frame is what the job makes of it.
bool Fits(const JobPlan& plan, int frame, const CommittedFrame& committed) {
  return committed.bundle.has_value() == plan.keeps_results() && frame >= 0 && frame < plan.resolved().num_frames &&
         committed.files.size() == plan.OutputPaths(frame).size() &&
         committed.picture_digests.size() == plan.resolved().views.size();
}

}  // namespace

Status Coordinator::Restore(TimePoint now) {
  now_ = now;
  DEPTHFARM_ASSIGN_OR_RETURN(const JobId last, journal_->LastJob());
  last_job_ = last.value();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<JournaledJob> jobs, journal_->Jobs());
  for (const JournaledJob& listed : jobs) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<JournaledJob> found, journal_->Find(listed.id));
    const JournaledJob& job = found ? *found : listed;
    if (job.ended) {
      const Status restored = RestoreEnded(job);
      if (!restored.ok()) LogWarning("job_not_restored", {{"job", job.id.value()}, {"reason", restored.message()}});
      continue;
    }
    const Status went_on = GoOn(job, false);
    if (went_on.ok() && job.state == JobState::kCancelled) Dispatch(JobCancelled{job.id});
    if (went_on.ok()) continue;
    // It cannot go on, and its submitter must hear of that.
    LogWarning("job_not_restored", {{"job", job.id.value()}, {"reason", went_on.message()}});
    v1::JobStatus status;
    status.set_job_id(job.id.value());
    v1::SubmitJob submission;
    if (submission.ParseFromString(job.submission)) {
      status.set_name(submission.name());
      status.set_priority(submission.priority());
      status.set_keeps_results(submission.keeps_results());
      *status.mutable_required_tags() = submission.required_tags();
    }
    const JobState state = job.state == JobState::kCancelled ? JobState::kCancelled : JobState::kFailed;
    status.set_state(ToProto(state));
    status.set_output_dir(job.output_dir);
    *status.mutable_error() =
        ToProto(went_on.WithContext("the coordinator was started again and the job cannot go on"));
    DEPTHFARM_RETURN_IF_ERROR(journal_->End(job.id, state, status.SerializeAsString()));
    history_.Add(status);
  }
  return {};
}

Status Coordinator::RestoreEnded(const JournaledJob& job) {
  v1::JobStatus status;
  if (!status.ParseFromString(job.status) || status.job_id() != job.id.value())
    return Corrupt("its status in the journal is damaged");
  history_.Add(status);
  if (!status.keeps_results() || job.submission.empty()) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(PlannedJob planned, PlanAgain(job));
  planned.config.algorithm_version = job.algorithm_version;  // that made them
  DEPTHFARM_ASSIGN_OR_RETURN(const CommittedFrames committed, FramesInPlace(planned, false));
  const ResolvedJob& resolved = planned.config.resolved;
  JobResults results;
  results.frames.resize(static_cast<std::size_t>(resolved.num_frames));
  results.picture_digests.resize(results.frames.size() * resolved.views.size());
  for (const auto& [frame, done] : committed) {
    const auto f = static_cast<std::size_t>(frame);
    results.frames[f] = {done.files, done.bundle};
    std::ranges::copy(done.picture_digests,
                      results.picture_digests.begin() + static_cast<std::ptrdiff_t>(f * resolved.views.size()));
  }
  kept_configs_[job.id] = ToProto(planned.config);
  Dispatch(ResultsRestored{job.id, std::move(results)});
  return {};
}

Result<PlannedJob> Coordinator::PlanAgain(const JournaledJob& job) {
  v1::SubmitJob submission;
  if (!submission.ParseFromString(job.submission)) return Corrupt("its submission in the journal is damaged");
  return PlanSubmission(submission, job.id);
}

Result<CommittedFrames> Coordinator::FramesInPlace(const PlannedJob& job, bool workers_are_here) const {
  const JobId id = job.config.job;
  DEPTHFARM_ASSIGN_OR_RETURN(CommittedFrames frames, journal_->Frames(id));
  const JobPlan plan(job);
  const bool fit =
      std::ranges::all_of(frames, [&](const auto& frame) { return Fits(plan, frame.first, frame.second); });
  if (!fit) return Corrupt("its frames in the journal are not those of the job");
  if (workers_are_here) {
    std::erase_if(frames, [this](const auto& frame) {
      return frame.second.bundle && scheduler_.HoldersOf(frame.second.bundle->key).empty();
    });
  }
  return frames;
}

Status Coordinator::GoOn(const JournaledJob& job, bool workers_are_here) {
  if (job.algorithm_version != kAlgorithmVersion) {
    return Status(ErrorCode::kIncompatible, Name(job.id) + " was begun by algorithm version " +
                                                std::to_string(job.algorithm_version) + ", this farm has " +
                                                std::to_string(kAlgorithmVersion) + ": submit it again");
  }
  v1::SubmitJob submission;
  if (job.submission.empty()) return Unavailable(Name(job.id) + " is too long ago to go on: submit it again");
  if (!submission.ParseFromString(job.submission)) return Corrupt("its submission in the journal is damaged");
  DEPTHFARM_ASSIGN_OR_RETURN(PlannedJob planned, PlanSubmission(submission, job.id));
  DEPTHFARM_ASSIGN_OR_RETURN(
      std::set<std::string> tags,
      CheckTags("required tags", {submission.required_tags().begin(), submission.required_tags().end()}));
  DEPTHFARM_ASSIGN_OR_RETURN(CommittedFrames committed, FramesInPlace(planned, workers_are_here));
  JournaledJob admitted = job;
  if (job.ended) admitted.state = JobState::kRunning;
  DEPTHFARM_RETURN_IF_ERROR(journal_->Admit(admitted, committed));
  Start(std::move(planned), submission, std::move(tags), std::move(committed), true);
  return {};
}

void Coordinator::Start(PlannedJob job, const v1::SubmitJob& submission, std::set<std::string> tags,
                        CommittedFrames committed, bool ran_before) {
  job.config.claim = ++last_claim_;
  jobs_[job.config.job] = {ToProto(job.config), Summary(job)};
  submitted_.emplace(job.config.job, now_);
  const bool serves_uploads = !job.uploads.empty();
  Dispatch(JobSubmitted{std::move(job), submission.name(), submission.priority(), std::move(tags), std::move(committed),
                        ran_before, serves_uploads});
}

Result<v1::Envelope> Coordinator::Retry(JobId id) {
  if (scheduler_.Job(id)) return InvalidArgument(Name(id) + " is still running");
  DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<JournaledJob> job, journal_->Find(id));
  if (!job) return InvalidArgument("there is no " + Name(id));
  if (!job->ended) return InvalidArgument(Name(id) + " is still running");
  if (job->state == JobState::kDone) return InvalidArgument(Name(id) + " is done: there is nothing to do again");
  const std::optional<JobId> other = job->output_dir.empty() ? std::nullopt : scheduler_.JobWritingTo(job->output_dir);
  if (other) {
    return InvalidArgument(Name(*other) + " writes to " + job->output_dir + ": wait for it, or cancel it");
  }
  v1::SubmitJob submission;
  if (submission.ParseFromString(job->submission) && submission.has_uploads_from()) {
    return InvalidArgument("the pictures of " + Name(id) +
                           " came from its submitter: submit it again with --upload, and what workers hold is reused");
  }
  DEPTHFARM_RETURN_IF_ERROR(GoOn(*job, true));
  if (scheduler_.Job(id)) history_.Remove(id);
  v1::Envelope answer;
  answer.mutable_job_accepted()->set_job_id(id.value());
  return answer;
}

}  // namespace depthfarm
