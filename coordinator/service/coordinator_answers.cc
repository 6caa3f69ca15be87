// What clients are told of jobs and workers.
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/bounds.h"
#include "common/wire/task_wire.h"
#include "coordinator/service/coordinator.h"
#include "coordinator/service/job_list_page.h"
#include "coordinator/service/logs_wire.h"
#include "coordinator/service/results_page.h"
#include "coordinator/service/status_wire.h"

namespace depthfarm {

Result<v1::Envelope> Coordinator::StatusOf(JobId id) const {
  v1::Envelope answer;
  if (const std::optional<JobSnapshot> job = scheduler_.Job(id)) {
    *answer.mutable_job_status() = FullStatus(*job);
    return answer;
  }
  if (const v1::JobStatus* job = history_.Find(id)) {
    *answer.mutable_job_status() = *job;
    return answer;
  }
  return InvalidArgument("there is no job " + std::to_string(id.value()));
}

v1::JobStatus Coordinator::FullStatus(const JobSnapshot& job) const {
  v1::JobStatus status = StatusToProto(job, jobs_.at(job.id).summary, now_);
  if (job.failed_task) AddFailedAttempts(attempts_, *job.failed_task, submitted_.at(job.id), now_, status);
  return status;
}

Result<v1::Envelope> Coordinator::ResultsOf(const v1::GetResults& request) const {
  const JobId id(request.job_id());
  const std::string name = "job " + std::to_string(id.value());
  DEPTHFARM_ASSIGN_OR_RETURN(const v1::Envelope status, StatusOf(id));
  const v1::JobStatus& job = status.job_status();
  if (!job.keeps_results()) {
    return InvalidArgument(name + " writes to " + job.output_dir() +
                           ": only the results of jobs that were submitted without an output folder can be fetched");
  }
  const JobResults* results = scheduler_.ResultsOf(id);
  const auto running = jobs_.find(id);
  const auto kept = kept_configs_.find(id);
  if (results == nullptr || (running == jobs_.end() && kept == kept_configs_.end())) {
    return InvalidArgument("the results of " + name + " were forgotten for those of later jobs: submit it again");
  }
  const auto locate = [this](const ArtifactKey& key) {
    std::vector<ArtifactLocation> locations;
    for (const WorkerId holder : scheduler_.HoldersOf(key)) {
      if (const WorkerSession* session = workers_.Find(holder)) locations.push_back(session->artifacts);
    }
    return locations;
  };
  v1::Envelope answer;
  v1::Results& page = *answer.mutable_results();
  page = ResultsPage(*results, request.first_frame(), locate);
  page.set_state(job.state());
  *page.mutable_error() = job.error();
  if (request.first_frame() == 0) *page.mutable_job() = running != jobs_.end() ? running->second.config : kept->second;
  return answer;
}

Result<v1::Envelope> Coordinator::LogsOf(const v1::GetJobLogs& request) const {
  const JobId id(request.job_id());
  DEPTHFARM_RETURN_IF_ERROR(StatusOf(id).status());
  const auto submitted = submitted_.find(id);
  const TimePoint since = submitted == submitted_.end() ? now_ : submitted->second;
  v1::Envelope answer;
  DEPTHFARM_ASSIGN_OR_RETURN(*answer.mutable_job_logs(), LogsToProto(attempts_, request, since, now_));
  return answer;
}

v1::Envelope Coordinator::ListJobs(const v1::ListJobs& request) const {
  // By id, whether they ended or not: one that ends between two pages is on one of them all the same.
  std::map<JobId, const JobSnapshot*> running;
  const std::vector<JobSnapshot> snapshots = scheduler_.Jobs();
  for (const JobSnapshot& job : snapshots) running[job.id] = &job;
  std::set<JobId> ids;
  for (const auto& [id, job] : history_.jobs()) ids.insert(id);
  for (const auto& [id, job] : running) ids.insert(id);

  JobListPage page(request);
  for (const JobId id : ids) {
    if (!page.IsAfter(id)) continue;
    v1::JobStatus status;
    if (const auto job = running.find(id); job != running.end()) {
      status = StatusToProto(*job->second, jobs_.at(id).summary, now_);
    } else {
      status = *history_.Find(id);
      status.clear_failed_attempts();  // all of them are too long for one message
    }
    if (!page.Add(std::move(status))) break;
  }
  v1::Envelope answer;
  *answer.mutable_job_list() = std::move(page).Take();
  return answer;
}

v1::Envelope Coordinator::ListWorkers() const {
  v1::Envelope answer;
  for (const WorkerSnapshot& worker : scheduler_.Workers()) {
    *answer.mutable_worker_list()->add_workers() = StatusToProto(worker, workers_.Find(worker.id), now_);
  }
  answer.mutable_worker_list();
  return answer;
}

Result<v1::Envelope> Coordinator::BacklogOf(const v1::GetBacklog& request) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::set<std::string> tags,
                             CheckTags("tags", {request.tags().begin(), request.tags().end()}));
  const Backlog backlog = scheduler_.BacklogOf(tags);
  v1::Envelope answer;
  answer.mutable_backlog()->set_leased(backlog.leased);
  answer.mutable_backlog()->set_ready(backlog.ready);
  answer.mutable_backlog()->set_unopened_gops(backlog.unopened_gops);
  return answer;
}

}  // namespace depthfarm
