#ifndef DEPTHFARM_WORKER_EXECUTION_TASK_EXECUTOR_H_
#define DEPTHFARM_WORKER_EXECUTION_TASK_EXECUTOR_H_

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "common/files/file_roots.h"
#include "common/job/task_spec.h"
#include "common/video_input/video_readers.h"
#include "worker/artifacts/memory_cache.h"
#include "worker/artifacts/store.h"
#include "worker/estimation/reward_floors.h"
#include "worker/execution/artifact_fetcher.h"
#include "worker/execution/lease_term.h"
#include "worker/execution/passed_rounds.h"
#include "worker/execution/task_inputs.h"
#include "worker/refinement/view_memory.h"

namespace depthfarm {

// How a task ended and what it made.
struct TaskOutcome {
  Status status;
  std::optional<ArtifactKey> output_key;        // Analyse: the name it found
  std::optional<ArtifactInfo> artifact;         // of tasks that make one; in the store
  std::vector<OutputFile> files;                // Emit, Render: written into the staging folder, or in the artifact
  std::optional<ContentDigest> picture_digest;  // Analyse
  std::vector<ArtifactKey> missing_inputs;      // inputs that could be had nowhere (kUnavailable)
  TaskStats stats;
  TaskLog log;  // of whoever runs the executor
  // Keep what it made and read in the store until the coordinator was told of it.
  std::shared_ptr<std::vector<ArtifactPins>> pins;
};

// Executes tasks of every kind, one at a time: inputs from memory, store or other workers, results into the store or
// the job's output folder. CPU is that of the thread that calls Execute and of those that help it in its loops; peak
// memory is that of the process so far. Not thread-safe.
class TaskExecutor {
 public:
  // All must outlive the executor. `threads`, >= 1: on how many a task is computed; results are the same for any.
  // `roots`: where tasks may read and write.
  TaskExecutor(ArtifactStore& store, MemoryCache& cache, ArtifactFetcher& fetcher, int threads = 1,
               FileRoots roots = {})
      : store_(store), cache_(cache), fetcher_(fetcher), threads_(threads), roots_(std::move(roots)) {}

  // Never throws. Errors name camera and frame (of the sequence): kInvalidArgument: the job or its pictures are wrong,
  // or outside of the roots;
  // kIncompatible: the job pins another algorithm version; kUnavailable: an input, a file, the disk or memory is out of
  // reach here; kCancelled, within a second after `stop` is requested.
  // kLeaseExpired: `still_leased` said no before something was written that others see.
  [[nodiscard]] TaskOutcome Execute(const TaskSpec& spec, const JobConfig& config, const std::stop_token& stop,
                                    const StillLeased& still_leased = {});

 private:
  struct Task;
  // The files of a task, in their order.
  struct MadeFiles {
    std::vector<OutputFile> files;
    std::vector<std::string> contents;  // of each, when the job keeps its results; else they are staged
  };

  [[nodiscard]] Status Run(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status Analyse(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status AnalysePicture(const Task& task, const JobView& view, TaskOutcome& outcome);
  // No other task reads the files that the submitter serves for this one.
  void ReleaseUploads(const Task& task);
  // The picture with its segments; of a P frame those of the frame before where it stands still.
  [[nodiscard]] static Result<ViewAnalysis> SegmentsOf(const Task& task, const JobView& view, YcbcrImage picture);
  [[nodiscard]] Status Estimate(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status Merge(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status Refine(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status Assess(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status Emit(const Task& task, TaskOutcome& outcome);
  [[nodiscard]] Status Render(const Task& task, TaskOutcome& outcome) const;
  [[nodiscard]] Status Commit(const Task& task);
  [[nodiscard]] Status Manifest(const Task& task);
  [[nodiscard]] Status EmitRefined(const Task& task, MadeFiles& made) const;
  [[nodiscard]] Status EmitLabels(const Task& task, MadeFiles& made) const;
  // Of a job that keeps its results: the frame's files that are in the store already.
  [[nodiscard]] bool ReuseFiles(const Task& task, TaskOutcome& outcome);
  // The files of a frame as one artifact.
  [[nodiscard]] Status StoreFiles(const Task& task, const MadeFiles& made, TaskOutcome& outcome);
  // Emits the files of each view, views on several threads, and lists them in their order.
  using EmitOne = std::function<Status(std::size_t view, MadeFiles& of_view)>;
  [[nodiscard]] Status EmitViews(const Task& task, const EmitOne& emit, MadeFiles& made) const;
  // Writes a file of the attempt, or keeps it.
  [[nodiscard]] static Status Stage(const Task& task, std::string path, std::string bytes, MadeFiles& made);
  // A depth map, as its job wants depth to be written.
  [[nodiscard]] static Status EmitDepth(const Task& task, const JobView& view, const Grid<std::uint16_t>& codes,
                                        MadeFiles& made);
  // An encoded map of a camera.
  [[nodiscard]] static Status EmitMap(const Task& task, const std::string& camera, const std::string& path,
                                      Result<std::string> bytes, MadeFiles& made);
  // What the task is to make, if it is here already and its file is whole; nothing otherwise.
  template <typename T>
  [[nodiscard]] std::shared_ptr<const T> FindMade(const Task& task, const ArtifactKey& key, TaskOutcome& outcome);
  // Whether the artifact (T: LabelField, RefinedView, ConfidenceMap) that the task is to make is here already.
  template <typename T>
  [[nodiscard]] bool Reuse(const Task& task, TaskOutcome& outcome);
  template <typename T>
  [[nodiscard]] Status Store(const Task& task, T object, TaskOutcome& outcome);

  ArtifactStore& store_;
  MemoryCache& cache_;
  ArtifactFetcher& fetcher_;
  const int threads_;
  const FileRoots roots_;
  FloorMemory floors_;
  VideoReaders videos_;
  ViewMemory refining_;
  PassedRounds passed_rounds_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_TASK_EXECUTOR_H_
