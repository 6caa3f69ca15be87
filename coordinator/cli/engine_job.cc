#include "coordinator/cli/engine_job.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "common/text/utc_time.h"
#include "coordinator/cli/engine_setup.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_on_farm.h"
#include "coordinator/clusters/cluster.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

constexpr int kMostFailures = 3;  // in a row

// The state folder of one run: goes with it, unless the user named it.
class RunFolder {
 public:
  RunFolder(fs::path path, bool keep) : path_(std::move(path)), keep_(keep) {}
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  ~RunFolder() {
    std::error_code ignored;
    if (!keep_) fs::remove_all(path_, ignored);
  }

 private:
  fs::path path_;
  bool keep_;
};

// A run has somebody who waits for it: it ends rather than asking for workers again and again that do not start.
Status LookAfter(Cluster& cluster) {
  DEPTHFARM_RETURN_IF_ERROR(cluster.Tick());
  if (cluster.failures() < kMostFailures) return {};
  return Unavailable("no worker starts: what was tried is said above; --state DIR keeps their logs");
}

}  // namespace

Result<LocalJob> RunOnEngine(const JobRequest& request, const EngineArguments& arguments, int threads) {
  const auto start = SteadyClock::now();
  EngineArguments named = arguments;
  named.options.name = "run-" + std::to_string(::getpid());
  DEPTHFARM_ASSIGN_OR_RETURN(ClusterOptions options, ResolveClusterOptions(named));
  options.threads = threads;
  options.keeps_journal = false;
  LocalJob result;
  result.started = FormatUtc(std::chrono::system_clock::now());
  result.workers = options.workers.max;
  result.slots = options.slots;
  result.threads = std::max(options.slots, threads);
  std::cerr << DescribeJob(request.resolved) << "; up to " << result.workers << " workers\n";

  DEPTHFARM_ASSIGN_OR_RETURN(const ClusterFolder folder, ClusterFolder::Make(options.state_dir));
  const RunFolder run_folder(folder.path(), !arguments.state_dir.empty());
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<ClusterFolder::Lock> lock, folder.TryLock());
  if (lock == nullptr) return InvalidArgument("--state names the folder of a cluster that is up: name another one");
  const auto tell = [](const std::string& line) { std::cerr << line << "\n"; };
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<Cluster> cluster,
                             Cluster::Start(options, folder, tell, Interrupted));
  Result<v1::JobStatus> job = RunOnFarm({.target = cluster->target(),
                                         .ended = [] { return false; },
                                         .look_after = [&cluster] { return LookAfter(*cluster); }},
                                        request);
  const bool interrupted = Interrupted();
  cluster->Stop();
  RemoveStaging(request.output_dir);
  if (interrupted) return Cancelled();
  if (!job.ok()) return job.status();
  result.status = std::move(job).value();
  result.wall_seconds = std::chrono::duration<double>(SteadyClock::now() - start).count();
  return result;
}

}  // namespace depthfarm
