#ifndef DEPTHFARM_COORDINATOR_METRICS_FARM_METRICS_H_
#define DEPTHFARM_COORDINATOR_METRICS_FARM_METRICS_H_

#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace depthfarm {

// A farm in numbers, at one moment. Totals count since the coordinator was started.
struct FarmMetrics {
  std::string version;
  int algorithm_version = 0;
  int protocol_version = 0;
  std::uint64_t jobs_running = 0;
  std::map<std::string, std::uint64_t> jobs_ended;  // by state
  // What jobs want: tasks that workers have, tasks that a free slot would get, GOPs to come.
  std::uint64_t tasks_leased = 0;
  std::uint64_t tasks_ready = 0;
  std::uint64_t gops_unopened = 0;
  std::uint64_t workers = 0;
  std::uint64_t workers_draining = 0;
  std::uint64_t slots = 0;  // of workers that are not draining
  std::uint64_t artifacts = 0;
  std::uint64_t artifact_bytes = 0;
  std::map<std::pair<std::string, std::string>, std::uint64_t> attempts;  // by kind of task and outcome
  std::map<std::string, double> cpu_seconds;                              // of attempts that made a result, by kind
  std::uint64_t late_results = 0;
  std::map<std::string, std::uint64_t> refused;  // handshakes and messages, by what was wrong
};

// As Prometheus reads it (text format 0.0.4): names begin with depthfarm_.
[[nodiscard]] std::string FormatMetrics(const FarmMetrics& metrics);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_METRICS_FARM_METRICS_H_
