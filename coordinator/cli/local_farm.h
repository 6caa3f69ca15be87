#ifndef DEPTHFARM_COORDINATOR_CLI_LOCAL_FARM_H_
#define DEPTHFARM_COORDINATOR_CLI_LOCAL_FARM_H_

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "coordinator/cli/private_folder.h"
#include "coordinator/cli/processes.h"

namespace depthfarm {

struct LocalFarmOptions {
  int workers = 1;
  int slots = 1;                  // of each worker
  int threads = 1;                // that they share
  std::filesystem::path log_dir;  // empty: in the private folder, gone with it
  std::string log_level = "info";
  std::filesystem::path cache_dir;      // shared by the workers and kept; empty: in the private folder, gone with it
  std::string cache_size;               // its bound, bytes; empty: the worker's own
  std::uint64_t task_memory_bytes = 0;  // of each worker; 0: as much as a worker alone on this machine
  int max_respawns = 5;                 // of workers, in all
};

// A coordinator and workers on this machine, talking over sockets in a private folder (0700) that also holds the
// workers' cache unless another one is named. Everything but that is gone when it ends, however it ends: processes by
// the kernel's parent-death signal if need be.
class LocalFarm {
 public:
  // kUnavailable: the programs are not beside this one, or the folder cannot be made.
  [[nodiscard]] static Result<std::unique_ptr<LocalFarm>> Start(const LocalFarmOptions& options);
  // Stops all processes and removes the folder.
  ~LocalFarm();
  LocalFarm(const LocalFarm&) = delete;
  LocalFarm& operator=(const LocalFarm&) = delete;

  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  [[nodiscard]] int respawns() const { return respawns_; }
  // Whether the coordinator has ended: no question will be answered any more.
  [[nodiscard]] bool CoordinatorEnded();
  // Looks after the processes: a worker that ended is started again. kInternal, with the ends of the logs, when the
  // coordinator has ended or workers ended more often than allowed.
  [[nodiscard]] Status Supervise();
  // The last lines of each log, for the report of a failure.
  [[nodiscard]] std::string LogTails() const;

 private:
  struct Worker {
    std::string name;
    ChildProcess process;
  };
  LocalFarm(LocalFarmOptions options, PrivateFolder folder);
  [[nodiscard]] Status StartProcesses();
  [[nodiscard]] Result<ChildProcess> StartWorker(const std::string& name) const;
  [[nodiscard]] std::filesystem::path LogOf(const std::string& name) const;

  LocalFarmOptions options_;
  PrivateFolder folder_;
  std::string endpoint_;
  std::filesystem::path worker_program_;
  std::unique_ptr<ChildProcess> coordinator_;
  std::vector<Worker> workers_;
  int respawns_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_LOCAL_FARM_H_
