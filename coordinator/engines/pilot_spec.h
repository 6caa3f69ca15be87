#ifndef DEPTHFARM_COORDINATOR_ENGINES_PILOT_SPEC_H_
#define DEPTHFARM_COORDINATOR_ENGINES_PILOT_SPEC_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace depthfarm {

// What every worker of a cluster is started with.
struct PilotSpec {
  std::string cluster = {};         // first part of the workers' names
  std::string worker_program = {};  // as the machines that run it find it
  std::string coordinator = {};     // endpoint as the workers reach it
  std::string keys_dir = {};        // as the workers see it; empty: no CURVE
  bool insecure = false;
  int slots = 1;
  int threads = 1;                 // that the slots share; one for each where that is more
  std::uint64_t memory_bytes = 0;  // of the whole worker; 0: what the machine has
  std::string cache_dir = {};      // empty: a temporary one
  std::string cache_size = {};     // empty: the worker's default
  std::vector<std::string> tags = {};
  std::vector<std::string> path_map = {};
  int give_up_seconds = 600;   // without the coordinator
  int stop_grace_seconds = 0;  // that tasks may take to end when the engine ends the worker
};

// The options of depthfarm-worker, but its name.
[[nodiscard]] std::vector<std::string> WorkerArguments(const PilotSpec& spec);

// Name on the farm of a pilot's worker: "CLUSTER.PILOT.RESTART"; restarts of a requeued pilot are workers of their own,
// since an orphan of the one before may still live.
[[nodiscard]] std::string WorkerName(std::string_view cluster, std::string_view pilot, std::string_view restart);
// The pilot of a worker with such a name; nothing for a worker of somebody else.
[[nodiscard]] std::optional<std::string> PilotOfWorker(std::string_view cluster, std::string_view worker);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_ENGINES_PILOT_SPEC_H_
