#include "coordinator/scheduling/kept_results.h"

#include <utility>

namespace depthfarm {

std::vector<ArtifactKey> KeptResults::Add(JobId job, JobResults results) {
  for (const JobResults::Frame& frame : results.frames) {
    num_files_ += frame.files.size();
    if (frame.bundle) ++wanted_[frame.bundle->key];
  }
  jobs_[job] = std::move(results);
  order_.push_back(job);
  std::vector<ArtifactKey> unwanted;
  while (num_files_ > most_files_ && order_.size() > 1) {
    const std::vector<ArtifactKey> of_oldest = Forget(order_.front());
    unwanted.insert(unwanted.end(), of_oldest.begin(), of_oldest.end());
  }
  return unwanted;
}

std::vector<ArtifactKey> KeptResults::Forget(JobId job) {
  std::vector<ArtifactKey> unwanted;
  const auto found = jobs_.find(job);
  if (found == jobs_.end()) return unwanted;
  for (const JobResults::Frame& frame : found->second.frames) {
    num_files_ -= frame.files.size();
    if (!frame.bundle || --wanted_.at(frame.bundle->key) > 0) continue;
    wanted_.erase(frame.bundle->key);
    unwanted.push_back(frame.bundle->key);
  }
  jobs_.erase(found);
  std::erase(order_, job);
  return unwanted;
}

const JobResults* KeptResults::Find(JobId job) const {
  const auto found = jobs_.find(job);
  return found == jobs_.end() ? nullptr : &found->second;
}

}  // namespace depthfarm
