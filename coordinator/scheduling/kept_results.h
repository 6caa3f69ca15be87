#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_KEPT_RESULTS_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_KEPT_RESULTS_H_

#include <cstddef>
#include <deque>
#include <map>
#include <vector>

#include "coordinator/scheduling/job_results.h"

namespace depthfarm {

// The results of jobs that ended and kept them, for those who fetch them later. Bounded: beyond `most_files` depth
// files in all, those of the jobs that ended first are forgotten.
class KeptResults {
 public:
  explicit KeptResults(std::size_t most_files = 4'000'000) : most_files_(most_files) {}

  // Both return the bundles that no job wants any more.
  [[nodiscard]] std::vector<ArtifactKey> Add(JobId job, JobResults results);
  [[nodiscard]] std::vector<ArtifactKey> Forget(JobId job);

  // Null when there are none (any more).
  [[nodiscard]] const JobResults* Find(JobId job) const;
  // Whether the artifact is the bundle of a frame.
  [[nodiscard]] bool Wants(const ArtifactKey& key) const { return wanted_.contains(key); }

 private:
  const std::size_t most_files_;
  std::size_t num_files_ = 0;
  std::map<JobId, JobResults> jobs_;
  std::deque<JobId> order_;            // in which they ended
  std::map<ArtifactKey, int> wanted_;  // by how many jobs
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_KEPT_RESULTS_H_
