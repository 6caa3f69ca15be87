#ifndef DEPTHFARM_WORKER_EXECUTION_EXECUTOR_TASK_H_
#define DEPTHFARM_WORKER_EXECUTION_EXECUTOR_TASK_H_

// What the source files of TaskExecutor share.

#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "worker/execution/output_folder.h"
#include "worker/execution/task_executor.h"

namespace depthfarm {

// What the steps of one task share.
struct TaskExecutor::Task {
  const TaskSpec& spec;
  const JobConfig& config;
  const std::stop_token& stop;
  const StillLeased& still_leased;
  TaskInputs& inputs;
  const FileRoots& roots;

  [[nodiscard]] const ResolvedJob& job() const { return config.resolved; }
  [[nodiscard]] int SequenceFrame() const { return job().params.first_frame + spec.id.frame; }
  [[nodiscard]] std::string FrameName() const {
    return config.render ? "part " + std::to_string(spec.id.frame) : "frame " + std::to_string(SequenceFrame());
  }
  [[nodiscard]] Result<OutputFolder> Output() const {
    DEPTHFARM_RETURN_IF_ERROR(roots.CheckWrite(config.output_dir));
    return OutputFolder::At(config.output_dir, config.render ? OutputContent::kViews : OutputContent::kDepth,
                            {.run = config.claim, .still_leased = still_leased});
  }
  // Of the first input of that role.
  [[nodiscard]] std::optional<ArtifactKey> KeyOf(InputRole role) const {
    for (const TaskInput& input : spec.inputs)
      if (input.role == role) return input.artifact.key;
    return std::nullopt;
  }
  [[nodiscard]] Status LoadInputs() const { return inputs.Load(spec, job().num_views()).WithContext(FrameName()); }
};

template <typename T>
std::shared_ptr<const T> TaskExecutor::FindMade(const Task& task, const ArtifactKey& key, TaskOutcome& outcome) {
  // Others are given the file, whatever is in memory here. Of a damaged one they say that it is missing, and this task
  // is asked for again: it would be as often as it is answered from memory.
  if (!store_.Get(key).ok()) return nullptr;
  auto made = task.inputs.Find<T>(key);
  if (made != nullptr) outcome.artifact = store_.Find(key);
  outcome.stats.reused = outcome.artifact.has_value();
  return outcome.stats.reused ? made : nullptr;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_EXECUTOR_TASK_H_
