#ifndef DEPTHFARM_COORDINATOR_FORECAST_JOB_FORECAST_H_
#define DEPTHFARM_COORDINATOR_FORECAST_JOB_FORECAST_H_

#include <cstdint>
#include <vector>

#include "common/job/resolved_job.h"
#include "common/job/task.h"

namespace depthfarm {

// All tasks of one kind, predicted.
struct StageForecast {
  TaskKind kind = TaskKind::kAnalyse;
  std::uint64_t tasks = 0;
  double seconds = 0;                   // CPU, of all of them; inputs in memory
  double longest_seconds = 0;           // of one
  std::uint64_t peak_memory_bytes = 0;  // of the largest
  std::uint64_t result_bytes = 0;       // stored, of all: artifacts; Emit: files
  std::uint64_t read_bytes = 0;         // stored, artifacts that all of them read, wherever they are
};

// The job on a farm of so many equal workers that do nothing else (list_schedule.h).
struct FarmForecast {
  int workers = 1;
  double wall_seconds = 0;
  double cpu_seconds = 0;         // with reading what other workers made
  std::uint64_t moved_bytes = 0;  // from worker to worker
};

// What a job will take, from its numbers alone (cost_model.h says how right that is). The same job, the same forecast.
struct JobForecast {
  std::vector<StageForecast> stages;  // those with tasks, in the order of TaskKind
  // The longest chain of tasks, each needing the one before, in the order they run: no farm is faster. Of a job that is
  // extrapolated the tasks are those of the frames that were played, the seconds those of the whole job.
  std::vector<TaskId> critical_path;
  double critical_seconds = 0;
  std::vector<FarmForecast> farms;
  bool more_do_not_help = false;  // twice the workers of the last farm gain less than a twentieth; only if tried
  int frames = 0;                 // of the job
  // About so many of the first ones were played through; if fewer, the farms' figures go on at the pace of the last
  // half of these or, of whole GOPs, at that of a farm that is as much smaller.
  int played_frames = 0;
  [[nodiscard]] bool extrapolated() const { return played_frames < frames; }
};

struct ForecastOptions {
  int workers = 0;                     // 0: 1, 2, 4, ... until a doubling gains less than a twentieth, at most 1024
  std::uint64_t most_tasks = 200'000;  // of a job that is played through as a whole
};

// `job` is one of estimation.
[[nodiscard]] JobForecast Forecast(const ResolvedJob& job, const ForecastOptions& options = {});

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_FORECAST_JOB_FORECAST_H_
