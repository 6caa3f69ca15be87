#ifndef DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_OPTIONS_H_
#define DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_OPTIONS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// How workers are provisioned.
enum class EngineKind { kLocal, kSlurm, kSsh };
[[nodiscard]] std::string_view EngineName(EngineKind kind);
// "local", "slurm", "ssh".
[[nodiscard]] Result<EngineKind> ParseEngine(std::string_view name);

// "4" or "4..64": bounds of the number of workers, 1 (the lower one 0) to 1024.
struct WorkerRange {
  int min = 1;
  int max = 1;
  bool operator==(const WorkerRange&) const = default;
};
[[nodiscard]] Result<WorkerRange> ParseWorkerRange(std::string_view text);

// All that `cluster up` was told. Paths are absolute.
struct ClusterOptions {
  std::string name = "default";  // letters, digits, '-' and '_', at most 32
  std::string state_dir;         // of this cluster alone; a batch system's nodes must see it
  EngineKind engine = EngineKind::kLocal;
  WorkerRange workers;
  int slots = 1;
  int threads = 1;                        // of each worker, as PilotSpec
  std::uint64_t worker_memory_bytes = 0;  // 0: what the machine has
  std::string worker_program;             // as its machines find it; empty: beside this program
  std::string cache_dir;                  // empty: a temporary one for each worker
  std::string cache_size;                 // empty: the worker's default
  std::vector<std::string> tags;
  std::vector<std::string> path_map;
  int idle_seconds = 120;
  // The coordinator: one that exists already, or one that is started at a port (0: a free one) of this host.
  std::string coordinator;  // endpoint of one that exists; empty: one is started
  std::string keys_dir;     // of one that exists; empty: made in the state folder
  bool insecure = false;
  std::string host;  // name that workers reach this host by; empty: its own
  int port = 0;
  bool keeps_journal = true;
  // As the manager of a job of its own, not beside the command that began it (Slurm).
  bool manager_as_job = false;
  // Slurm
  std::string partition;
  std::string time;
  std::string account;
  std::string qos;
  std::vector<std::string> engine_arguments;  // of sbatch, or of ssh
  // ssh
  std::string hosts_file;

  bool operator==(const ClusterOptions&) const = default;
};

// Options that do not fit each other or the engine, with the name of the option.
[[nodiscard]] Status CheckClusterOptions(const ClusterOptions& options);

// The form that a manager is handed them in, a JSON object.
[[nodiscard]] std::string ClusterOptionsToJson(const ClusterOptions& options);
// kCorrupt: it is none.
[[nodiscard]] Result<ClusterOptions> ClusterOptionsFromJson(std::string_view text);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_OPTIONS_H_
