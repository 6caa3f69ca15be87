#include "coordinator/cli/local_farm.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kStopGrace{3000};
constexpr std::size_t kTailLines = 8;

std::string Tail(const fs::path& log) {
  std::ifstream file(log);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back(std::move(line));
    if (lines.size() > kTailLines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "    " + line + "\n";
  return text;
}

}  // namespace

LocalFarm::LocalFarm(LocalFarmOptions options, PrivateFolder folder)
    : options_(std::move(options)),
      folder_(std::move(folder)),
      endpoint_("ipc://" + (folder_.path() / "coordinator").string()) {
  if (options_.log_dir.empty()) options_.log_dir = folder_.path() / "logs";
  if (options_.cache_dir.empty()) options_.cache_dir = folder_.path() / "cache";
}

Result<std::unique_ptr<LocalFarm>> LocalFarm::Start(const LocalFarmOptions& options) {
  DEPTHFARM_ASSIGN_OR_RETURN(PrivateFolder folder, PrivateFolder::Make());
  std::unique_ptr<LocalFarm> farm(new LocalFarm(options, std::move(folder)));
  DEPTHFARM_RETURN_IF_ERROR(farm->StartProcesses());
  return farm;
}

Status LocalFarm::StartProcesses() {
  std::error_code error;
  fs::create_directories(options_.log_dir, error);
  if (error) return Unavailable("cannot make log folder " + options_.log_dir.string() + ": " + error.message());
  DEPTHFARM_ASSIGN_OR_RETURN(const fs::path coordinator_program, SiblingProgram("depthfarm-coordinator"));
  DEPTHFARM_ASSIGN_OR_RETURN(worker_program_, SiblingProgram("depthfarm-worker"));
  DEPTHFARM_ASSIGN_OR_RETURN(ChildProcess coordinator, ChildProcess::Start(coordinator_program,
                                                                           {"--listen", endpoint_, "--journal", "none",
                                                                            "--log-level", options_.log_level},
                                                                           LogOf("coordinator")));
  coordinator_ = std::make_unique<ChildProcess>(std::move(coordinator));
  for (int i = 1; i <= options_.workers; ++i) {
    const std::string name = "worker-" + std::to_string(i);
    DEPTHFARM_ASSIGN_OR_RETURN(ChildProcess process, StartWorker(name));
    workers_.push_back({name, std::move(process)});
  }
  return {};
}

Result<ChildProcess> LocalFarm::StartWorker(const std::string& name) const {
  std::vector<std::string> arguments = {"--coordinator",
                                        endpoint_,
                                        "--cache-dir",
                                        options_.cache_dir.string(),
                                        "--slots",
                                        std::to_string(options_.slots),
                                        "--threads",
                                        std::to_string(options_.threads),
                                        "--exit-with-parent",
                                        "--give-up-seconds",
                                        "30",
                                        "--log-level",
                                        options_.log_level};
  if (!options_.cache_size.empty()) arguments.insert(arguments.end(), {"--cache-size", options_.cache_size});
  if (options_.task_memory_bytes > 0) {
    arguments.insert(arguments.end(), {"--task-memory", std::to_string(options_.task_memory_bytes)});
  }
  return ChildProcess::Start(worker_program_, arguments, LogOf(name));
}

LocalFarm::~LocalFarm() {
  for (Worker& worker : workers_) worker.process.Signal(SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + kStopGrace;
  for (Worker& worker : workers_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    worker.process.Stop(std::max(std::chrono::milliseconds(1), left));
  }
  // After them: a worker that cannot say goodbye waits half a second for somebody to say it to.
  if (coordinator_) coordinator_->Stop(kStopGrace);
}

fs::path LocalFarm::LogOf(const std::string& name) const { return options_.log_dir / (name + ".log"); }

bool LocalFarm::CoordinatorEnded() { return coordinator_->Poll().has_value(); }

Status LocalFarm::Supervise() {
  if (const std::optional<ProcessEnd> end = coordinator_->Poll()) {
    return Internal("the coordinator " + Describe(*end) + "\n" + LogTails());
  }
  for (Worker& worker : workers_) {
    const std::optional<ProcessEnd> end = worker.process.Poll();
    if (!end) continue;
    if (respawns_ >= options_.max_respawns) {
      return Internal(worker.name + " " + Describe(*end) + "; workers have been started again " +
                      std::to_string(respawns_) + " times already\n" + LogTails());
    }
    ++respawns_;
    std::cerr << worker.name << " (process " << worker.process.pid() << ") " << Describe(*end)
              << "; starting it again\n";
    DEPTHFARM_ASSIGN_OR_RETURN(worker.process, StartWorker(worker.name));
  }
  return {};
}

std::string LocalFarm::LogTails() const {
  std::string text = "  end of coordinator.log:\n" + Tail(LogOf("coordinator"));
  for (const Worker& worker : workers_) text += "  end of " + worker.name + ".log:\n" + Tail(LogOf(worker.name));
  return text;
}

}  // namespace depthfarm
