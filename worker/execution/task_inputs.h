#ifndef DEPTHFARM_WORKER_EXECUTION_TASK_INPUTS_H_
#define DEPTHFARM_WORKER_EXECUTION_TASK_INPUTS_H_

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/memory_cache.h"
#include "worker/artifacts/store.h"
#include "worker/confidence/confidence.h"
#include "worker/estimation/estimation.h"
#include "worker/execution/artifact_fetcher.h"
#include "worker/refinement/refine.h"

namespace depthfarm {

// The decoded inputs of one task: from memory, else from the store, else from other workers (and then kept in both).
class TaskInputs {
 public:
  TaskInputs(ArtifactStore& store, MemoryCache& cache, ArtifactFetcher& fetcher, const std::stop_token& stop)
      : store_(store), cache_(cache), fetcher_(fetcher), stop_(stop) {}

  // Loads all inputs of `spec`, so that a failure names every one that is missing (see missing()).
  // Errors: kUnavailable: some could be had nowhere; kInvalidArgument: an input that no task of that kind and job has;
  // kCancelled.
  [[nodiscard]] Status Load(const TaskSpec& spec, int num_views);

  // Of a role, one per view in order. kInvalidArgument when the task does not list exactly one per view.
  [[nodiscard]] Result<FrameAnalysis> Analyses(InputRole role) const;
  // Of a role, by view; null for views that the task does not list.
  [[nodiscard]] FrameAnalysis ListedAnalyses(InputRole role) const;
  [[nodiscard]] FrameRefinement ListedRefined(InputRole role) const;
  [[nodiscard]] std::vector<std::shared_ptr<const ConfidenceMap>> ListedConfidence() const;
  // Of a role, in the order of the task. kInvalidArgument unless there are `count`.
  [[nodiscard]] Result<std::vector<std::shared_ptr<const LabelField>>> Labels(InputRole role, std::size_t count) const;

  // From memory or the store alone; null when it is not there (or is damaged: then it is dropped).
  // T: ViewAnalysis, LabelField, RefinedView or ConfidenceMap.
  template <typename T>
  [[nodiscard]] std::shared_ptr<const T> Find(const ArtifactKey& key);

  [[nodiscard]] const std::vector<ArtifactKey>& missing() const { return missing_; }
  [[nodiscard]] double fetch_seconds() const { return fetch_seconds_; }
  [[nodiscard]] std::uint64_t fetched_bytes() const { return fetched_bytes_; }

 private:
  struct Loaded {
    InputRole role;
    int view;
    std::shared_ptr<const ViewAnalysis> analysis;  // of the analysis roles
    std::shared_ptr<const LabelField> labels;      // of the label roles
    std::shared_ptr<const RefinedView> refined;    // of the refined roles
    std::shared_ptr<const ConfidenceMap> confidence;
  };
  [[nodiscard]] Status LoadOne(const TaskInput& input);
  [[nodiscard]] Result<std::string> Fetch(const TaskInput& input);
  template <typename T>
  [[nodiscard]] Result<std::shared_ptr<const T>> FindOrFetch(const TaskInput& input);

  ArtifactStore& store_;
  MemoryCache& cache_;
  ArtifactFetcher& fetcher_;
  const std::stop_token stop_;
  int num_views_ = 0;
  std::vector<Loaded> loaded_;
  std::vector<ArtifactKey> missing_;
  double fetch_seconds_ = 0;
  std::uint64_t fetched_bytes_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_TASK_INPUTS_H_
