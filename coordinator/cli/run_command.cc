#include <filesystem>
#include <iostream>

#include "common/base/host_name.h"
#include "common/files/atomic_file.h"
#include "common/files/writable_folder.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/engine_job.h"
#include "coordinator/cli/engine_setup.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/kept_cache.h"
#include "coordinator/cli/local_job.h"
#include "coordinator/cli/progress.h"
#include "coordinator/cli/report.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

nlohmann::ordered_json RunJson(const JobRequest& request, const LocalJob& job) {
  nlohmann::ordered_json json = JobToJson(job.status);
  json["sequence"] = request.sequence.file;
  json["host"] = HostName();
  json["started"] = job.started;
  json["wallSeconds"] = job.wall_seconds;
  json["workers"] = job.workers;
  json["slots"] = job.slots;
  json["threads"] = job.threads;
  json["respawns"] = job.respawns;
  return json;
}

// What was computed is there for the next run, which goes on where this one was interrupted.
Result<KeptCache> CacheOf(const RunArguments& arguments) {
  if (arguments.no_cache) return KeptCache();
  DEPTHFARM_ASSIGN_OR_RETURN(KeptCache cache, OpenKeptCache(arguments.engine.options.cache_dir));
  if (!cache.note.empty()) std::cerr << "depthfarm: " << cache.note << "\n";
  return cache;
}

// On this machine, or on an engine.
Result<LocalJob> RunOnOwnFarm(const JobRequest& request, const RunArguments& arguments) {
  DEPTHFARM_ASSIGN_OR_RETURN(const EngineKind engine, ParseEngine(arguments.engine.engine));
  if (engine != EngineKind::kLocal) {
    if (!arguments.farm.worker_log_dir.empty() || arguments.farm.log_level != LocalFarmArguments().log_level) {
      return InvalidArgument(
          "--worker-log-dir and --log-level are for workers of this machine: of an engine's the logs "
          "are in the folder that --state names");
    }
    return RunOnEngine(request, arguments.engine, arguments.farm.threads);
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckNoEngineOptions(arguments.engine));
  LocalFarmArguments farm = arguments.farm;
  if (!arguments.engine.workers.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const WorkerRange workers, ParseWorkerRange(arguments.engine.workers));
    if (workers.min != workers.max) return InvalidArgument("bounds of --workers need --engine slurm or --engine ssh");
    farm.workers = workers.max;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const KeptCache cache, CacheOf(arguments));
  if (!cache.folder.empty()) {
    farm.cache_dir = cache.folder.string();
    farm.cache_size = arguments.engine.options.cache_size;
    if (farm.cache_size.empty()) farm.cache_size = std::to_string(cache.bytes);
  }
  Result<LocalJob> job = RunLocally(request, farm);
  if (!job.ok() && Interrupted() && !cache.folder.empty()) {
    std::cerr << "depthfarm: what was computed is kept: the same command goes on from there\n";
  }
  return job;
}

}  // namespace

int Execute(const RunArguments& arguments) {
  CatchInterruptions();
  const Result<JobRequest> request = PrepareJobRequest(arguments.job);
  if (!request.ok()) return Fail(request.status());
  // The workers are on this machine too: what they could not write is not worth computing.
  if (const Status writable = CheckWritableFolder(request->output_dir); !writable.ok()) return Fail(writable);
  const Result<LocalJob> job = RunOnOwnFarm(*request, arguments);
  if (!job.ok() && Interrupted()) {
    std::cerr << "depthfarm: interrupted, the job was cancelled\n";
    return kExitInterrupted;
  }
  if (!job.ok()) return Fail(job.status());

  const nlohmann::ordered_json run = RunJson(*request, *job);
  if (fs::is_directory(request->output_dir)) {
    const Status written =
        WriteFileAtomically((fs::path(request->output_dir) / "run.json").string(), run.dump(2) + "\n");
    if (!written.ok()) return Fail(written);
  }
  if (arguments.json) {
    std::cout << run.dump(2) << "\n";
  } else {
    std::cout << FormatJob(job->status, BegunAnewBy::kSameCommand)
              << "  wall time: " << FormatDuration(job->wall_seconds) << "\n";
  }
  if (job->status.state() != v1::JOB_STATE_DONE) {
    std::cerr << "depthfarm: " << job->status.error().message() << "\n" << job->log_tails;
  }
  return ExitCodeOfJob(job->status);
}

}  // namespace depthfarm
