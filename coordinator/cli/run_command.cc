#include <sys/utsname.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <thread>

#include "common/files/atomic_file.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_request.h"
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

std::string HostName() {
  utsname system = {};
  return ::uname(&system) == 0 ? system.nodename : "";
}

// What happened while a job ran on a local farm.
struct RunRecord {
  std::string started = UtcNow();
  SteadyClock::time_point start = SteadyClock::now();
  int workers = 0;
  int respawns = 0;

  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(SteadyClock::now() - start).count(); }
};

nlohmann::ordered_json RunJson(const RunRecord& record, const JobRequest& request, const v1::JobStatus& job) {
  nlohmann::ordered_json json = JobToJson(job);
  json["sequence"] = request.sequence.file;
  json["host"] = HostName();
  json["started"] = record.started;
  json["wallSeconds"] = record.seconds();
  json["workers"] = record.workers;
  json["respawns"] = record.respawns;
  return json;
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
  fs::remove_all(fs::path(output_dir) / ".depthfarm-staging", ignored);
}

}  // namespace

int Execute(const RunArguments& arguments) {
  CatchInterruptions();
  const Result<JobRequest> request = PrepareJobRequest(arguments.job);
  if (!request.ok()) return Fail(request.status());
  RunRecord record;
  record.workers = WorkerCount(arguments.farm.workers);
  std::cerr << DescribeJob(request->resolved) << "; " << record.workers << " workers\n";
  Result<std::unique_ptr<LocalFarm>> farm = LocalFarm::Start(
      {.workers = record.workers, .log_dir = arguments.farm.worker_log_dir, .log_level = arguments.farm.log_level});
  if (!farm.ok()) return Fail(farm.status());
  const Result<v1::JobStatus> job = RunOn(*farm.value(), *request);
  const bool interrupted = Interrupted();
  Status farm_status = interrupted ? Cancelled() : job.status();
  if (!interrupted && !job.ok()) {  // the reason lies with a process rather than with the question that got no answer
    if (Status supervised = farm.value()->Supervise(); !supervised.ok()) farm_status = supervised;
  }
  record.respawns = farm.value()->respawns();
  const bool show_logs = job.ok() && ExitCodeOfJob(*job) == kExitFailed;
  const std::string log_tails = show_logs ? farm.value()->LogTails() : "";  // of bad input the reason says all
  farm.value().reset();
  RemoveStaging(request->output_dir);
  if (interrupted) {
    std::cerr << "depthfarm: interrupted, the job was cancelled\n";
    return kExitInterrupted;
  }
  if (!job.ok()) return Fail(farm_status);

  const nlohmann::ordered_json run = RunJson(record, *request, *job);
  if (fs::is_directory(request->output_dir)) {
    const Status written =
        WriteFileAtomically((fs::path(request->output_dir) / "run.json").string(), run.dump(2) + "\n");
    if (!written.ok()) return Fail(written);
  }
  if (arguments.json) {
    std::cout << run.dump(2) << "\n";
  } else {
    std::cout << FormatJob(*job) << "  wall time: " << FormatDuration(record.seconds()) << "\n";
  }
  if (job->state() != v1::JOB_STATE_DONE) std::cerr << "depthfarm: " << job->error().message() << "\n" << log_tails;
  return ExitCodeOfJob(*job);
}

}  // namespace depthfarm
