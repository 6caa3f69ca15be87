#ifndef DEPTHFARM_COORDINATOR_CLI_CLUSTER_REPORT_H_
#define DEPTHFARM_COORDINATOR_CLI_CLUSTER_REPORT_H_

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/clusters/cluster_folder.h"
#include "coordinator/engines/engine.h"
#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// What there is to say about a cluster.
struct ClusterReport {
  ClusterRecord record;
  bool managed = false;                      // whether its manager lives
  std::optional<v1::Backlog> backlog;        // absent: the coordinator did not answer
  std::vector<v1::WorkerStatus> workers;     // those of the cluster
  std::optional<std::vector<Pilot>> pilots;  // absent: the engine did not answer, or only its manager knows
};

[[nodiscard]] std::string FormatCluster(const ClusterReport& report);
[[nodiscard]] nlohmann::ordered_json ClusterToJson(const ClusterReport& report);

// How to use a cluster: lines for the shell.
[[nodiscard]] std::string HowToSubmit(const ClusterRecord& record);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_CLUSTER_REPORT_H_
