#include "coordinator/service/job_history.h"

namespace depthfarm {

void JobHistory::Add(const v1::JobStatus& job) {
  const JobId id(job.job_id());
  Remove(id);
  jobs_[id] = job;
  order_.push_back(id);
  while (order_.size() > max_jobs_) Remove(order_.front());
}

void JobHistory::Remove(JobId id) {
  if (jobs_.erase(id) > 0) std::erase(order_, id);
}

const v1::JobStatus* JobHistory::Find(JobId id) const {
  const auto job = jobs_.find(id);
  return job == jobs_.end() ? nullptr : &job->second;
}

}  // namespace depthfarm
