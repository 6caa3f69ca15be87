#include "coordinator/cli/local_job.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "common/base/machine_memory.h"
#include "common/text/utc_time.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/farm_shape.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_on_farm.h"
#include "coordinator/cli/local_farm.h"
#include "coordinator/cli/progress.h"

namespace depthfarm {
namespace {

using SteadyClock = std::chrono::steady_clock;

std::string Describe(const FarmShape& shape) {
  const std::string workers = std::to_string(shape.workers) + (shape.workers == 1 ? " worker" : " workers");
  return shape.slots == 1 ? workers : workers + " of " + std::to_string(shape.slots) + " slots";
}

int Cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace

Result<LocalJob> RunLocally(const JobRequest& request, const LocalFarmArguments& arguments) {
  const auto start = SteadyClock::now();
  LocalJob result;
  result.started = FormatUtc(std::chrono::system_clock::now());
  const FarmShape shape = ShapeOfFarm(arguments.workers, arguments.slots, Cores());
  result.workers = shape.workers;
  result.slots = shape.slots;
  result.threads = std::max(shape.slots, arguments.threads);
  std::cerr << DescribeJob(request.resolved) << "; " << Describe(shape) << "\n";
  const std::uint64_t task_memory = TaskMemory(MachineMemory(), kUsualCacheBytes, result.workers);
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<LocalFarm> farm, LocalFarm::Start({.workers = result.workers,
                                                                                .slots = shape.slots,
                                                                                .threads = arguments.threads,
                                                                                .log_dir = arguments.worker_log_dir,
                                                                                .log_level = arguments.log_level,
                                                                                .cache_dir = arguments.cache_dir,
                                                                                .cache_size = arguments.cache_size,
                                                                                .task_memory_bytes = task_memory}));
  Result<v1::JobStatus> job = RunOnFarm({.target = {.endpoint = farm->endpoint(), .keys_dir = ""},
                                         .ended = [&farm] { return farm->CoordinatorEnded(); },
                                         .look_after = [&farm] { return farm->Supervise(); }},
                                        request);
  const bool interrupted = Interrupted();
  Status farm_status = interrupted ? Cancelled() : job.status();
  if (!interrupted && !job.ok()) {  // the reason lies with a process rather than with the question that got no answer
    if (Status supervised = farm->Supervise(); !supervised.ok()) farm_status = supervised;
  }
  result.respawns = farm->respawns();
  // Of bad input the reason says all.
  if (job.ok() && ExitCodeOfJob(*job) == kExitFailed) result.log_tails = farm->LogTails();
  farm.reset();
  RemoveStaging(request.output_dir);
  if (!farm_status.ok()) return farm_status;
  result.status = std::move(job).value();
  result.wall_seconds = std::chrono::duration<double>(SteadyClock::now() - start).count();
  return result;
}

}  // namespace depthfarm
