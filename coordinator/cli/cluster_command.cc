#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>

#include "common/files/atomic_file.h"
#include "common/text/utc_time.h"
#include "coordinator/cli/cluster_report.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/engine_setup.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/processes.h"
#include "coordinator/clusters/cluster.h"
#include "coordinator/engines/command.h"
#include "coordinator/engines/pilot_spec.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPause{200};
constexpr std::chrono::seconds kStartLimit{60};
constexpr std::chrono::seconds kDownLimit{90};
constexpr std::chrono::seconds kSlurmLimit{60};
constexpr std::chrono::milliseconds kAnswerLimit{5000};
constexpr std::uint64_t kMostLogBytes = std::uint64_t{1} << 30;

void Tell(const std::string& line) { std::cerr << line << std::endl; }
void TellWithTime(const std::string& line) { Tell(FormatUtc(std::chrono::system_clock::now()) + " " + line); }

Result<ClusterFolder> OpenFolder(const EngineArguments& arguments) {
  std::string path = arguments.state_dir;
  if (path.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(path, ClusterFolder::DefaultPath(arguments.options.name));
  }
  return ClusterFolder::Open(fs::absolute(path).lexically_normal());
}

Status NotUp(const ClusterFolder& folder) {
  return InvalidArgument("the cluster in " + folder.path().string() + " is not up");
}

// What the log has beyond `begin`.
std::string LogFrom(const fs::path& log, std::uintmax_t begin) {
  const Result<std::string> text = ReadFileBytes(log.string(), kMostLogBytes);
  return text.ok() && text->size() > begin ? text->substr(begin) : "";
}

// In this process, until somebody asks it to end.
int Manage(const ClusterFolder& folder) {
  CatchInterruptions();
  const Result<ClusterOptions> options = folder.ReadOptions();
  if (!options.ok()) return Fail(options.status());
  const auto lock = folder.TryLock();
  if (!lock.ok()) return Fail(lock.status());
  if (*lock == nullptr) {
    return Fail(InvalidArgument("the cluster in " + folder.path().string() +
                                " is up already: see depthfarm cluster status, or end it with depthfarm cluster down"));
  }
  // Of a manager that was killed.
  const Result<std::optional<ClusterRecord>> before = folder.ReadRecord();
  if (!before.ok()) return Fail(before.status());
  if (*before) {
    if (const Status removed = RemoveLeftovers(**before, folder); !removed.ok()) return Fail(removed);
  }
  folder.ForgetDown();
  const Result<std::unique_ptr<Cluster>> cluster = Cluster::Start(*options, folder, TellWithTime);
  if (!cluster.ok()) return Fail(cluster.status());
  Status status;
  while (status.ok() && !Interrupted() && !folder.AskedDown()) {
    status = (*cluster)->Tick();
    PauseUnlessInterrupted(kPause);
  }
  (*cluster)->Stop();
  folder.ForgetDown();
  return status.ok() ? kExitOk : Fail(status);
}

// Tells that a manager has ended, and which; nothing as long as it has not.
using EndOfManager = std::function<std::optional<std::string>()>;

Result<EndOfManager> StartManager(const ClusterOptions& options, const ClusterFolder& folder) {
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path self, SiblingProgram("depthfarm"));
  const std::vector<std::string> words = {"cluster", "manage", "--state", folder.path().string()};
  if (!options.manager_as_job) {
    DEPTHFARM_ASSIGN_OR_RETURN(const pid_t manager, StartDetached(self, words, folder.manager_log()));
    return EndOfManager([manager]() -> std::optional<std::string> {
      int status = 0;
      if (::waitpid(manager, &status, WNOHANG) != manager) return std::nullopt;
      return "the manager ended";
    });
  }
  std::string script = "#!/bin/sh\nexec " + ShellQuoted(self.string());
  for (const std::string& word : words) script += " " + ShellQuoted(word);
  std::vector<std::string> sbatch = {
      "sbatch",    "--parsable",         "--job-name=depthfarm-" + options.name + "-manager", "--ntasks=1",
      "--requeue", "--open-mode=append", "--output=" + folder.manager_log().string()};
  for (const auto& [option, value] :
       {std::pair("--partition=", options.partition), {"--account=", options.account}, {"--qos=", options.qos}}) {
    if (!value.empty()) sbatch.push_back(option + value);
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const CommandOutput submitted, RunCommand(sbatch, script + "\n", {.usual = kSlurmLimit}));
  if (submitted.exit_code != 0) return Unavailable("sbatch: " + submitted.error);
  std::string job = submitted.output.substr(0, submitted.output.find_first_of(";\n"));
  Tell("the manager is job " + job + " of Slurm");
  return EndOfManager([job]() -> std::optional<std::string> {
    const auto queue = RunCommand({"squeue", "--noheader", "--jobs=" + job, "--format=%T"}, "", {.usual = kSlurmLimit});
    if (!queue.ok() || (queue->exit_code == 0 && !queue->output.empty())) return std::nullopt;
    return "job " + job + " ended";
  });
}

int Up(const ClusterArguments& arguments) {
  CatchInterruptions();
  const Result<ClusterOptions> options = ResolveClusterOptions(arguments.engine);
  if (!options.ok()) return Fail(options.status());
  const Result<ClusterFolder> folder = ClusterFolder::Make(options->state_dir);
  if (!folder.ok()) return Fail(folder.status());
  {
    const auto lock = folder->TryLock();
    if (!lock.ok()) return Fail(lock.status());
    if (*lock == nullptr) {
      return Fail(InvalidArgument("cluster " + options->name + " is up already (" + folder->path().string() +
                                  "): end it with depthfarm cluster down, or give this one another --name"));
    }
    if (const Status written = folder->WriteOptions(*options); !written.ok()) return Fail(written);
    const Result<std::optional<ClusterRecord>> before = folder->ReadRecord();
    if (!before.ok()) return Fail(before.status());
    if (*before) {
      if (const Status removed = RemoveLeftovers(**before, *folder); !removed.ok()) return Fail(removed);
      folder->RemoveRecord();
    }
  }
  if (arguments.foreground) return Manage(*folder);

  std::error_code missing;
  const std::uintmax_t size = fs::file_size(folder->manager_log(), missing);
  const std::uintmax_t log_begin = missing ? 0 : size;
  const auto ended = StartManager(*options, *folder);
  if (!ended.ok()) return Fail(ended.status());
  // A batch job may wait for long; what is asked for stays asked for when this command is interrupted.
  const auto deadline = SteadyClock::now() + kStartLimit;
  while (options->manager_as_job || SteadyClock::now() < deadline) {
    const Result<std::optional<ClusterRecord>> record = folder->ReadRecord();
    if (!record.ok()) return Fail(record.status());
    if (*record) {
      std::cout << "cluster " << options->name << " is up; to use it:\n" << HowToSubmit(**record);
      return kExitOk;
    }
    if (const std::optional<std::string> end = (*ended)()) {
      std::cerr << "depthfarm: " << *end << ":\n" << LogFrom(folder->manager_log(), log_begin);
      return kExitFailed;
    }
    if (Interrupted()) return kExitInterrupted;
    PauseUnlessInterrupted(kPause);
  }
  return Fail(Unavailable("the manager does not start, see " + folder->manager_log().string()));
}

int ShowStatus(const ClusterArguments& arguments) {
  const Result<ClusterFolder> folder = OpenFolder(arguments.engine);
  if (!folder.ok()) return Fail(folder.status());
  const Result<std::optional<ClusterRecord>> record = folder->ReadRecord();
  if (!record.ok()) return Fail(record.status());
  if (!*record) return Fail(NotUp(*folder));
  ClusterReport report{.record = **record, .managed = false, .backlog = {}, .workers = {}, .pilots = {}};
  const auto lock = folder->TryLock();
  report.managed = lock.ok() && *lock == nullptr;
  const Result<std::unique_ptr<Client>> client = Client::Connect({.endpoint = report.record.coordinator,
                                                                  .keys_dir = report.record.keys_dir,
                                                                  .insecure = report.record.options.insecure},
                                                                 {.timeout = kAnswerLimit, .stop = nullptr});
  if (!client.ok()) return Fail(client.status());
  if (const Result<v1::Backlog> backlog = client.value()->GetBacklog(report.record.options.tags); backlog.ok()) {
    report.backlog = *backlog;
    const Result<std::vector<v1::WorkerStatus>> workers = client.value()->ListWorkers();
    if (workers.ok()) {
      std::ranges::copy_if(*workers, std::back_inserter(report.workers), [&](const v1::WorkerStatus& worker) {
        return PilotOfWorker(report.record.instance, worker.name()).has_value();
      });
    }
  }
  // Processes that the manager started are known to it alone; of them the coordinator tells those that joined.
  if (report.record.options.engine == EngineKind::kSlurm) {
    const Result<std::unique_ptr<Engine>> engine = OpenEngine(report.record, *folder);
    if (!engine.ok()) return Fail(engine.status());
    const Result<std::vector<Pilot>> pilots = engine.value()->List();
    if (!pilots.ok()) return Fail(pilots.status());
    report.pilots = *pilots;
  }
  std::cout << (arguments.json ? ClusterToJson(report).dump(2) + "\n" : FormatCluster(report));
  return report.backlog ? kExitOk : kExitNoCoordinator;
}

int Down(const ClusterArguments& arguments) {
  CatchInterruptions();
  const Result<ClusterFolder> folder = OpenFolder(arguments.engine);
  if (!folder.ok()) return Fail(folder.status());
  const Result<std::optional<ClusterRecord>> record = folder->ReadRecord();
  if (!record.ok()) return Fail(record.status());
  if (!*record) return Fail(NotUp(*folder));
  {
    const auto lock = folder->TryLock();
    if (!lock.ok()) return Fail(lock.status());
    if (*lock != nullptr) {
      // Its manager was killed, and the coordinator with it.
      if (const Status removed = RemoveLeftovers(**record, *folder); !removed.ok()) return Fail(removed);
      folder->RemoveRecord();
      return kExitOk;
    }
  }
  if (const Status asked = folder->AskDown(); !asked.ok()) return Fail(asked);
  const auto deadline = SteadyClock::now() + kDownLimit;
  while (SteadyClock::now() < deadline) {
    const auto lock = folder->TryLock();
    if (lock.ok() && *lock != nullptr) return kExitOk;
    if (Interrupted()) return kExitInterrupted;
    PauseUnlessInterrupted(kPause);
  }
  return Fail(Unavailable("the manager, process " + std::to_string((*record)->manager_pid) + " on " +
                          (*record)->manager_host + ", does not end; see " + folder->manager_log().string()));
}

}  // namespace

int Execute(const ClusterArguments& arguments) {
  switch (arguments.action) {
    case ClusterArguments::Action::kUp:
      return Up(arguments);
    case ClusterArguments::Action::kStatus:
      return ShowStatus(arguments);
    case ClusterArguments::Action::kDown:
      return Down(arguments);
    case ClusterArguments::Action::kManage: {
      const Result<ClusterFolder> folder = OpenFolder(arguments.engine);
      return folder.ok() ? Manage(*folder) : Fail(folder.status());
    }
  }
  return kExitBadInput;
}

}  // namespace depthfarm
