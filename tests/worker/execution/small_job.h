#ifndef DEPTHFARM_TESTS_WORKER_EXECUTION_SMALL_JOB_H_
#define DEPTHFARM_TESTS_WORKER_EXECUTION_SMALL_JOB_H_

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/job/task_spec.h"
#include "tests/support/temporary_folder.h"
#include "worker/execution/task_executor.h"

namespace depthfarm {

// Fetches from the stores of other workers in this process, by key alone.
class StoreFetcher : public ArtifactFetcher {
 public:
  [[nodiscard]] Result<std::string> Fetch(const TaskInput& input, const std::stop_token& stop) override;
  std::vector<ArtifactStore*> stores;
  int fetches = 0;
};

// One worker's executing side.
struct TestWorker {
  explicit TestWorker(int threads = 1);
  TaskOutcome Execute(const TaskSpec& spec, const JobConfig& config) { return executor.Execute(spec, config, {}); }

  testing_support::TemporaryFolder folder;
  std::unique_ptr<ArtifactStore> store;
  MemoryCache cache{64 << 20};
  StoreFetcher fetcher;
  std::unique_ptr<TaskExecutor> owned_executor;
  TaskExecutor& executor;
};

// A job of three views of two planes and two frames (an I and a P frame), two level blocks each, two rounds of
// refinement, with its pictures on disk; sequence frames 5 and 6. Makes the specs of its tasks as a coordinator does.
class SmallJob {
 public:
  SmallJob();

  [[nodiscard]] TaskSpec Simple(TaskKind kind) const;
  [[nodiscard]] TaskSpec Analyse(int frame, int view) const;
  [[nodiscard]] TaskSpec Estimate(int frame, int block) const;
  [[nodiscard]] TaskSpec Merge(int frame) const;
  [[nodiscard]] TaskSpec Refine(int frame, int round, int view) const;
  [[nodiscard]] TaskSpec Assess(int frame, int view) const;
  [[nodiscard]] TaskSpec Emit(int frame) const;
  [[nodiscard]] TaskSpec Commit(int frame) const;
  [[nodiscard]] TaskSpec Manifest() const;
  // Remembers what a task made for the specs of later ones.
  void Note(const TaskSpec& spec, const TaskOutcome& outcome);
  // Runs the whole job, task by task, on the workers in turn; the first failure ends it.
  [[nodiscard]] Status RunOn(const std::vector<TestWorker*>& workers);

  [[nodiscard]] std::filesystem::path output() const { return folder_.path() / "out"; }
  [[nodiscard]] std::filesystem::path picture(int frame, int view) const;

  JobConfig config;

 private:
  [[nodiscard]] TaskSpec Spec(TaskKind kind, int frame, int index) const;
  void AddAnalyses(TaskSpec& spec, InputRole role, int frame) const;
  void AddOfView(TaskSpec& spec, InputRole role, const TaskId& producer, int view) const;
  void AddLabels(TaskSpec& spec, InputRole role, const TaskId& producer) const;
  [[nodiscard]] static TaskId FinalLabels(int frame);
  [[nodiscard]] static TaskId Refined(int frame, int round, int view);

  testing_support::TemporaryFolder folder_;
  std::map<TaskId, ArtifactInfo> artifacts_;
  std::map<TaskId, ContentDigest> pictures_;
  std::map<int, std::vector<OutputFile>> files_;  // by frame
};

// All views of the I frame.
[[nodiscard]] Status AnalyseFirstFrame(SmallJob& job, TestWorker& worker);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_EXECUTION_SMALL_JOB_H_
