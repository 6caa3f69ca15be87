#include "coordinator/cli/local_job.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "common/base/machine_memory.h"
#include "common/sequence/output_layout.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/local_farm.h"
#include "coordinator/cli/progress.h"
#include "coordinator/cli/report.h"
#include "coordinator/client/client.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollInterval{100};
constexpr std::chrono::milliseconds kCancelTimeout{2000};
constexpr std::chrono::milliseconds kCleanupLimit{5000};

int WorkerCount(int asked) {
  if (asked > 0) return asked;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::string UtcNow() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts = {};
  ::gmtime_r(&now, &parts);
  char text[32] = "";
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

// Asks the coordinator to cancel and waits until the tasks that tidy up are through.
void CancelAndWait(const LocalFarm& farm, std::uint64_t job_id) {
  const Result<std::unique_ptr<Client>> client =
      Client::Connect({.endpoint = farm.endpoint(), .keys_dir = ""}, {.timeout = kCancelTimeout, .stop = nullptr});
  if (!client.ok() || !client.value()->Cancel(job_id).ok()) return;
  const auto deadline = SteadyClock::now() + kCleanupLimit;
  while (SteadyClock::now() < deadline) {
    const Result<v1::JobStatus> job = client.value()->GetStatus(job_id);
    if (!job.ok() || (job->state() != v1::JOB_STATE_RUNNING && job->running().empty())) return;
    std::this_thread::sleep_for(kPollInterval);
  }
}

// Submits the job and follows it to its end. Status: the farm failed, or the run was interrupted.
Result<v1::JobStatus> RunOn(LocalFarm& farm, const JobRequest& request) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<Client> client,
                             Client::Connect({.endpoint = farm.endpoint(), .keys_dir = ""},
                                             {.stop = [&farm] { return Interrupted() || farm.CoordinatorEnded(); }}));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t job_id, client->Submit({.sequence = request.sequence,
                                                                         .params = request.params,
                                                                         .output_dir = request.output_dir,
                                                                         .name = request.sequence.name}));
  ProgressLine progress;
  Result<v1::JobStatus> last = FollowJob(*client, job_id, kPollInterval, [&](const v1::JobStatus& job) {
    progress.Show(FormatProgress(job));
    return job.state() == v1::JOB_STATE_RUNNING ? farm.Supervise() : Status();
  });
  progress.Finish();
  if (!last.ok()) CancelAndWait(farm, job_id);
  return last;
}

// Nothing runs any more: what a killed worker left half-written can go.
void RemoveStaging(const std::string& output_dir) {
  std::error_code ignored;
  fs::remove_all(fs::path(output_dir) / kStagingFolder, ignored);
}

}  // namespace

Result<LocalJob> RunLocally(const JobRequest& request, const LocalFarmArguments& arguments) {
  const auto start = SteadyClock::now();
  LocalJob result;
  result.started = UtcNow();
  result.workers = WorkerCount(arguments.workers);
  result.threads = arguments.threads;
  std::cerr << DescribeJob(request.resolved) << "; " << result.workers << " workers\n";
  const std::uint64_t task_memory = TaskMemory(MachineMemory(), kUsualCacheBytes, result.workers);
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<LocalFarm> farm, LocalFarm::Start({.workers = result.workers,
                                                                                .threads = arguments.threads,
                                                                                .log_dir = arguments.worker_log_dir,
                                                                                .log_level = arguments.log_level,
                                                                                .task_memory_bytes = task_memory}));
  Result<v1::JobStatus> job = RunOn(*farm, request);
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
