#ifndef DEPTHFARM_COORDINATOR_PLANNING_ARTIFACT_KEYS_H_
#define DEPTHFARM_COORDINATOR_PLANNING_ARTIFACT_KEYS_H_

#include <span>
#include <string>

#include "common/job/task_spec.h"

namespace depthfarm {

// Names of the label fields and refined views of a job. Two tasks, of whatever jobs, have the same key only when their
// operation, algorithm version, version of the result's bytes, level planes, cameras, parameters that reach the results
// of such tasks, level block or round and view, and inputs are the same; output folders, names, priorities, GOP length
// and frame numbers do not count. Keys of Analyse are the worker's: they need the picture; AnalysisRequest stands for
// them until it is read.
class ArtifactKeys {
 public:
  explicit ArtifactKeys(const JobConfig& config);

  struct Input {
    InputRole role = InputRole::kAnalysis;
    ArtifactKey key{};
  };
  // `inputs` in the order of the TaskSpec.
  [[nodiscard]] ArtifactKey Estimate(int num_blocks, int block, std::span<const Input> inputs) const;
  [[nodiscard]] ArtifactKey Merge(std::span<const Input> inputs) const;
  [[nodiscard]] ArtifactKey Refine(int round, int view, std::span<const Input> inputs) const;
  // Of all that an Analyse task reads and does, with the names of its files in place of what they hold.
  [[nodiscard]] static ArtifactKey AnalysisRequest(const JobConfig& config, int view, const std::string& picture,
                                                   const GuideFiles& guides, std::span<const Input> inputs);
  [[nodiscard]] ArtifactKey Assess(int view, std::span<const Input> inputs) const;
  // Of the files of a frame, whose names count: those of cameras and the frame's position in the sequence.
  [[nodiscard]] ArtifactKey Emit(int frame_of_sequence, std::span<const Input> inputs) const;

 private:
  Partition partition_;
  int search_step_;      // of one block; that of several follows
  ArtifactKey job_;      // of what all tasks of the job share
  ArtifactKey refined_;  // of what its Refine and Assess tasks share besides
  ArtifactKey files_;    // of what its Emit tasks share besides
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_PLANNING_ARTIFACT_KEYS_H_
