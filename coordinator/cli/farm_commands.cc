#include <chrono>
#include <iostream>

#include "common/files/writable_folder.h"
#include "common/transport/farm_keys.h"
#include "common/wire/bounds.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/fetch_session.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/logs_report.h"
#include "coordinator/cli/progress.h"
#include "coordinator/cli/report.h"
#include "coordinator/client/client.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kWatchInterval{500};

// The command that shows what happened to a job, for the shell.
std::string LogsCommand(const FarmArguments& farm, std::uint64_t job_id) {
  std::string command = "depthfarm logs " + std::to_string(job_id);
  if (farm.coordinator != FarmArguments().coordinator) command += " --coordinator " + farm.coordinator;
  if (!farm.keys.empty()) command += " --keys " + farm.keys;
  if (farm.insecure) command += " --insecure";
  return command;
}

// Watches a job until it ends and prints how it ended.
int WatchToTheEnd(Client& client, const FarmArguments& farm, std::uint64_t job_id, bool json) {
  ProgressLine progress;
  const Result<v1::JobStatus> last = FollowJob(client, job_id, kWatchInterval, [&](const v1::JobStatus& job) {
    progress.Show("job " + std::to_string(job_id) + ": " + FormatProgress(job));
    return Status();
  });
  progress.Finish();
  if (!last.ok()) return FailAsking(last.status());
  std::cout << (json ? JobToJson(*last).dump(2) + "\n" : FormatJob(*last)) << std::flush;
  if (last->state() == v1::JOB_STATE_FAILED)
    std::cerr << "what happened to its tasks: " << LogsCommand(farm, job_id) << "\n";
  return ExitCodeOfJob(*last);
}

}  // namespace

int Fail(const Status& status) {
  std::cerr << "depthfarm: " << status.message() << "\n";
  return ExitCodeOf(status.code());
}

int FailAsking(const Status& status) {
  const int code = Fail(status);
  return status.code() == ErrorCode::kUnavailable ? kExitNoCoordinator : code;
}

int Execute(const SubmitArguments& arguments) {
  CatchInterruptions();
  if (const auto tags = CheckTags("--require", arguments.required_tags); !tags.ok()) return Fail(tags.status());
  if (arguments.upload) return SubmitWithUploads(arguments);
  Result<JobRequest> request =
      arguments.job.output_dir.empty() ? ReadJobRequest(arguments.job) : PrepareJobRequest(arguments.job);
  if (!request.ok()) return Fail(request.status());
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const std::string name = arguments.name.empty() ? request->sequence.name : arguments.name;
  std::cerr << DescribeJob(request->resolved) << "\n";
  const Result<std::uint64_t> job_id = client.value()->Submit({.sequence = std::move(request->sequence),
                                                               .params = request->params,
                                                               .output_dir = request->output_dir,
                                                               .name = name,
                                                               .priority = arguments.priority,
                                                               .required_tags = arguments.required_tags});
  if (!job_id.ok()) return FailAsking(job_id.status());
  if (arguments.wait) return WatchToTheEnd(*client.value(), arguments.farm, *job_id, arguments.json);
  if (arguments.json) {
    std::cout << nlohmann::ordered_json{{"job", *job_id}}.dump() << "\n";
  } else {
    std::cout << *job_id << "\n";
  }
  return kExitOk;
}

int Execute(const StatusArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Result<v1::JobStatus> job = client.value()->GetStatus(arguments.job);
  if (!job.ok()) return FailAsking(job.status());
  std::cout << (arguments.json ? JobToJson(*job).dump(2) + "\n" : FormatJob(*job));
  return kExitOk;
}

int Execute(const WatchArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  return WatchToTheEnd(*client.value(), arguments.farm, arguments.job, arguments.json);
}

int Execute(const LogsArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Result<v1::JobLogs> logs = client.value()->GetLogs(arguments.job, arguments.task);
  if (!logs.ok()) return FailAsking(logs.status());
  std::cout << (arguments.json ? LogsToJson(*logs).dump(2) + "\n" : FormatLogs(*logs));
  return kExitOk;
}

int Execute(const JobsArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Result<std::vector<v1::JobStatus>> jobs = client.value()->ListJobs();
  if (!jobs.ok()) return FailAsking(jobs.status());
  if (!arguments.json) {
    std::cout << FormatJobs(*jobs);
    return kExitOk;
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const v1::JobStatus& job : *jobs) list.push_back(JobToJson(job));
  std::cout << list.dump(2) << "\n";
  return kExitOk;
}

int Execute(const CancelArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Status cancelled = client.value()->Cancel(arguments.job);
  return cancelled.ok() ? kExitOk : FailAsking(cancelled);
}

int Execute(const RetryArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Status goes_on = client.value()->Retry(arguments.job);
  if (!goes_on.ok()) return FailAsking(goes_on);
  if (arguments.wait) return WatchToTheEnd(*client.value(), arguments.farm, arguments.job, arguments.json);
  if (arguments.json) std::cout << nlohmann::ordered_json{{"job", arguments.job}}.dump() << "\n";
  return kExitOk;
}

int Execute(const WorkersArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Result<std::vector<v1::WorkerStatus>> workers = client.value()->ListWorkers();
  if (!workers.ok()) return FailAsking(workers.status());
  if (!arguments.json) {
    std::cout << FormatWorkers(*workers);
    return kExitOk;
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const v1::WorkerStatus& worker : *workers) list.push_back(WorkerToJson(worker));
  std::cout << list.dump(2) << "\n";
  return kExitOk;
}

int Execute(const DrainArguments& arguments) {
  CatchInterruptions();
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
  if (!client.ok()) return FailAsking(client.status());
  const Status drained = client.value()->Drain(arguments.worker);
  return drained.ok() ? kExitOk : FailAsking(drained);
}

int Execute(const KeygenArguments& arguments) {
  if (const Status writable = CheckWritableFolder(arguments.output_dir); !writable.ok()) return Fail(writable);
  const Status created = CreateFarmKeys(arguments.output_dir);
  if (!created.ok()) return Fail(created);
  std::cout << "keys of a farm are in " << arguments.output_dir << "\n"
            << "  coordinator's host:  coordinator.key, authorized\n"
            << "  worker hosts:        worker.key, worker.pub, coordinator.pub, authorized\n"
            << "  submitters:          client.key, client.pub, coordinator.pub; with --upload also authorized\n"
            << "Move *.key over an encrypted channel (scp); they are refused when others may read them.\n";
  return kExitOk;
}

}  // namespace depthfarm
