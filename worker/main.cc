#include <malloc.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/freed_memory.h"
#include "common/files/atomic_file.h"
#include "common/files/file_confinement.h"
#include "common/log/log.h"
#include "common/log/log_collector.h"
#include "common/transport/descriptor_limit.h"
#include "common/transport/endpoint.h"
#include "common/video_input/video_module.h"
#include "common/wire/bounds.h"
#include "worker/minding/minder.h"
#include "worker/service/death_notice.h"
#include "worker/service/worker_service.h"

namespace depthfarm {
namespace {

constexpr int kExitOk = 0;
constexpr int kExitFailed = 1;
constexpr int kExitBadUsage = 2;
constexpr int kExitNoCoordinator = 3;

// Of one task for the next: asked for page by page it takes 2 to 3 % of the time. Goes back when there is no task.
constexpr FreedMemory kKeptOfTasks{.most_bytes = 256U << 20U, .largest_block_bytes = 32U << 20U};

std::atomic<WorkerService*> running_service = nullptr;
std::atomic<bool> stop_signalled = false;
std::atomic<bool> hung_up = false;  // while it started

extern "C" void OnSignal(int) {
  stop_signalled = true;
  if (WorkerService* service = running_service) service->Stop();
}

extern "C" void OnHangup(int) {
  if (WorkerService* service = running_service) {
    service->RereadKeys();
  } else {
    hung_up = true;
  }
}

// Of the process that works: what its minder passes on (minder.h) ends the worker, also while it still starts, or has
// keys read again. A write to a closed pipe is an error like any other.
void InstallSignalHandlers() {
  struct sigaction handler {};
  handler.sa_handler = OnSignal;
  sigemptyset(&handler.sa_mask);
  sigaction(MindedStop(), &handler, nullptr);
  handler.sa_handler = OnHangup;
  handler.sa_flags = SA_RESTART;  // nothing that a task does is to fail by it
  sigaction(MindedHangup(), &handler, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

// A private folder for a worker that was not given one.
class TemporaryCache {
 public:
  TemporaryCache() = default;
  TemporaryCache(const TemporaryCache&) = delete;
  TemporaryCache& operator=(const TemporaryCache&) = delete;
  ~TemporaryCache() { Remove(); }

  [[nodiscard]] Status Make() {
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    std::string name = ((error ? "/tmp" : parent) / "depthfarm-worker-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      return Unavailable("cannot make a folder like " + name + ": name a --cache-dir");
    path_ = name;
    return {};
  }
  void Remove() {
    std::error_code ignored;  // nobody is left to be told
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    path_.clear();
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

int ExitCodeOf(const Status& status) {
  switch (status.code()) {
    case ErrorCode::kOk:
    case ErrorCode::kCancelled:
      return kExitOk;
    case ErrorCode::kInvalidArgument:
      return kExitBadUsage;
    case ErrorCode::kUnavailable:
      return kExitNoCoordinator;
    default:
      return kExitFailed;
  }
}

int Fail(const Status& status, int code) {
  std::cerr << "depthfarm-worker: " << status.message() << "\n";
  return code;
}

// Gives up the right to open what neither jobs nor this worker need. Before the first thread starts.
Status ConfineTo(const WorkerOptions& options) {
  if (options.cache_dir.empty())
    return InvalidArgument("--read-root and --write-root need a --cache-dir: they leave no other folder to write to");
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(options.cache_dir.string()));
  FileAccess access{options.roots.read(), options.roots.write(), {}};
  access.write.push_back(options.cache_dir);
  if (!options.keys.empty()) access.read.push_back(options.keys);
  // Other workers fetch through a socket there.
  for (const std::string& endpoint : {options.coordinator, options.artifact_listen}) {
    if (endpoint.empty()) continue;
    DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint parsed, ParseEndpoint(endpoint));
    if (parsed.kind != Endpoint::Kind::kIpc) continue;
    const std::filesystem::path folder = std::filesystem::absolute(parsed.path).parent_path();
    access.sockets.push_back(parsed.path == "*" ? std::filesystem::temp_directory_path() : folder);
  }
  (void)LoadVideoModule();  // it may lie outside of what is left; where there is none, a video's task says so
  return ConfineFiles(access);
}

// In the process that works.
int RunWorker(WorkerOptions options) {
  // Threads that compute come and go: each would keep a heap of its own with all that was freed there. They allocate
  // rarely enough for those of a slot to share one.
  mallopt(M_ARENA_MAX, options.slots);  // NOLINT(concurrency-mt-unsafe): before the first thread
  KeepFreedMemory(kKeptOfTasks);
  RaiseDescriptorLimit();
  if (options.roots.confined()) {
    const Status confined = ConfineTo(options);
    if (!confined.ok())
      return Fail(confined, confined.code() == ErrorCode::kInvalidArgument ? kExitBadUsage : kExitFailed);
  }
  TemporaryCache cache;
  if (options.cache_dir.empty()) {
    const Status made = cache.Make();
    if (!made.ok()) return Fail(made, kExitFailed);
    options.cache_dir = cache.path();
  }
  Result<std::unique_ptr<WorkerService>> service = WorkerService::Create(options);
  if (!service.ok()) {
    const bool usage = service.status().code() == ErrorCode::kInvalidArgument;
    return Fail(service.status(), usage ? kExitBadUsage : kExitFailed);
  }
  running_service = service->get();
  if (stop_signalled) (*service)->Stop();
  if (hung_up) (*service)->RereadKeys();
  const Status status = (*service)->Run();
  running_service = nullptr;
  const int code = status.ok() ? kExitOk : Fail(status, ExitCodeOf(status));
  if ((*service)->busy()) {
    // A task that does not notice its stop must not keep the process: its result was given up already.
    LogWarning("task_left_behind");
    cache.Remove();
    std::_Exit(code);
  }
  return code;
}

// Whether a worker that ends so has said goodbye, or never came.
bool EndedInOrder(const MindedEnd& end) {
  return end.signal == 0 &&
         (end.exit_code == kExitOk || end.exit_code == kExitBadUsage || end.exit_code == kExitNoCoordinator);
}

// Runs the worker in a process of its own and tells the coordinator if that dies of a task. Ends as the worker did.
int MindWorker(WorkerOptions options, bool exit_with_parent) {
  Identify(options);
  Result<std::unique_ptr<ComputingLeases>> computing = ComputingLeases::Make(options.slots);
  if (!computing.ok()) return Fail(computing.status(), kExitFailed);
  options.computing = std::move(computing).value();
  InstallSignalHandlers();
  // Without keys SIGHUP ends the program as always.
  const Result<MindedEnd> end = RunMinded({.hangup = !options.keys.empty(), .end_with_parent = exit_with_parent},
                                          [&options] { return RunWorker(options); });
  if (!end.ok()) return Fail(end.status(), kExitFailed);
  if (!EndedInOrder(*end)) {
    LogError("worker_died", {{"name", options.name}, {"how", Describe(*end)}});
    const Status told = SendDeathNotice(options, Describe(*end), end->last_words);
    if (!told.ok()) LogWarning("death_not_told", {{"reason", told.message()}});
  }
  EndLike(*end);
}

}  // namespace
}  // namespace depthfarm

int main(int argc, char** argv) {
  using namespace depthfarm;  // NOLINT(google-build-using-namespace): the program's own
  // CLI11 takes -1 for a size of 20 digits. The transform that is named last is the first to see the text.
  const CLI::Validator no_minus(
      [](const std::string& text) {
        return text.find('-') == std::string::npos ? "" : "is '" + text + "', expected a size such as 20GB";
      },
      "SIZE");
  CLI::App app(
      "Worker of a depthfarm: leases tasks from a coordinator, computes them, serves its artifacts to other workers.");
  app.set_version_flag("--version", std::string(DEPTHFARM_VERSION));
  WorkerOptions options;
  options.software_version = DEPTHFARM_VERSION;
  std::string keys;
  std::string cache_dir;
  std::vector<std::string> path_map;
  std::vector<std::string> read_roots;
  std::vector<std::string> write_roots;
  std::string log_level = "info";
  double give_up_seconds = 0;
  double stop_grace_seconds = 0;
  app.add_option("--coordinator", options.coordinator, "tcp://HOST:PORT or ipc://PATH of the coordinator")->required();
  app.add_option(
      "--keys", keys,
      "folder with worker.key, worker.pub and coordinator.pub (see depthfarm keygen), and authorized: who may fetch\n"
      "from this worker, read again on SIGHUP");
  app.add_flag("--insecure", options.insecure, "tcp without keys, on loopback addresses only");
  app.add_option(
      "--cache-dir", cache_dir,
      "folder of the artifacts, kept between runs; workers of one host may share it: what one has made or fetched "
      "none of them fetches again; default: a temporary one");
  app.add_option("--cache-size", options.cache_bytes,
                 "bound of that folder, e.g. 20GB; of a shared one the same for all")
      ->transform(CLI::AsSizeValue(false))
      ->transform(no_minus)
      ->default_str("8GB");
  app.add_option("--memory", options.memory_bytes, "bound of the decoded artifacts kept in memory, e.g. 4GB")
      ->transform(CLI::AsSizeValue(false))
      ->transform(no_minus)
      ->default_str("2GB");
  app.add_option("--slots", options.slots, "tasks computed at a time; they share cache and memory")
      ->check(CLI::Range(1, kMaxWorkerSlots))
      ->capture_default_str();
  app.add_option("--ahead", options.ahead, "tasks taken besides, whose inputs are fetched meanwhile")
      ->check(CLI::Range(0, kMaxWorkerSlots))
      ->capture_default_str();
  app.add_option(
         "--task-memory", options.task_memory_bytes,
         "memory for tasks: a task whose predicted need does not fit beside the others goes elsewhere or waits; "
         "default: that of the machine or its control group, less --memory, which is right for one worker on a host")
      ->transform(CLI::AsSizeValue(false))
      ->transform(no_minus);
  app.add_option("--path-map", path_map,
                 "what jobs name below FROM is below TO on this host, e.g. /shared=/mnt/nas; may be repeated: the "
                 "longest FROM counts")
      ->type_name("FROM=TO")
      ->allow_extra_args(false);
  app.add_option("--read-root", read_roots,
                 "jobs may read below this folder of this host, wherever links lead, and nowhere else but below those "
                 "of --write-root; may be repeated; without any they may read and write what this account can")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_option("--write-root", write_roots, "jobs may write below this folder and nowhere else; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
  app.add_option("--tags", options.tags, "what this worker has, for jobs submitted with --require, e.g. fast,room2")
      ->delimiter(',');
  app.add_option("--threads", options.threads,
                 "threads that the slots share, at least one each: a task takes those that would be idle; results are "
                 "the same for any number")
      ->type_name("N")
      ->check(CLI::Range(1, kMostWorkerThreads))
      ->capture_default_str();
  app.add_option("--name", options.name, "name on the farm; default: host:process:random");
  app.add_option("--artifact-listen", options.artifact_listen,
                 "endpoint for other workers; default: beside the coordinator's ipc socket, else a free tcp port");
  app.add_option("--advertise", options.advertise, "host name or address that other workers reach this one by");
  app.add_option("--log-level", log_level, "debug, info, warning, error or off")->capture_default_str();
  bool exit_with_parent = false;
  app.add_flag("--exit-with-parent", exit_with_parent, "end when the process that started this one ends");
  app.add_option("--give-up-seconds", give_up_seconds, "end after so long without the coordinator; 0: never")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option(
         "--stop-grace", stop_grace_seconds,
         "seconds that tasks may take to end after SIGTERM or SIGINT before they are handed back; a second signal "
         "hands them back at once; default: 0")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1e6));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitBadUsage;
  }
  const Result<std::set<std::string>> tags = CheckTags("--tags", options.tags);
  if (!tags.ok()) return Fail(tags.status(), kExitBadUsage);
  Result<PathMap> paths = PathMap::Parse(path_map);
  if (!paths.ok()) return Fail(paths.status(), kExitBadUsage);
  options.paths = std::move(*paths);
  Result<FileRoots> roots = FileRoots::Of(read_roots, write_roots);
  if (!roots.ok()) return Fail(roots.status(), kExitBadUsage);
  options.roots = std::move(*roots);
  options.keys = keys;
  options.cache_dir = cache_dir;
  options.stop_grace = Milliseconds(static_cast<std::int64_t>(stop_grace_seconds * 1000));
  if (give_up_seconds > 0) options.give_up = Milliseconds(static_cast<std::int64_t>(give_up_seconds * 1000));
  const Status level = SetLogLevel(log_level);
  if (!level.ok()) return Fail(level, kExitBadUsage);
  CaptureStandardError();
  return MindWorker(std::move(options), exit_with_parent);
}
