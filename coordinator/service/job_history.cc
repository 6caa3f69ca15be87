#include "coordinator/service/job_history.h"

namespace depthfarm {

void JobHistory::Add(const v1::JobStatus& job) {
  jobs_[JobId(job.job_id())] = job;
  while (jobs_.size() > max_jobs_) jobs_.erase(jobs_.begin());
}

const v1::JobStatus* JobHistory::Find(JobId id) const {
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? nullptr : &job->second;
}

}  // namespace depthfarm
