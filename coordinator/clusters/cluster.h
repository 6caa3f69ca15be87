#ifndef DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_H_
#define DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_H_

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "coordinator/cli/processes.h"
#include "coordinator/client/client.h"
#include "coordinator/clusters/cluster_folder.h"
#include "coordinator/clusters/cluster_options.h"
#include "coordinator/clusters/scaler.h"
#include "coordinator/engines/command.h"
#include "coordinator/engines/engine.h"

namespace depthfarm {

// The engine of a cluster whose coordinator is known. kUnavailable: the engine does not answer; kInvalidArgument: its
// options are wrong.
[[nodiscard]] Result<std::unique_ptr<Engine>> OpenEngine(const ClusterRecord& record, const ClusterFolder& folder,
                                                         InHurry in_hurry = {});

// Ends what is left of a cluster whose manager is gone: its pilots.
[[nodiscard]] Status RemoveLeftovers(const ClusterRecord& record, const ClusterFolder& folder);

// A farm on somebody else's machines: a coordinator that this process starts (or one that exists), and as many workers
// as there is work for, which an engine provides. One manager has it: Tick must be called again and again.
class Cluster {
 public:
  // Told what happened, a line each.
  using Log = std::function<void(const std::string&)>;

  // Starts the coordinator, opens the engine and writes the record. Errors as those of CheckClusterOptions;
  // kUnavailable: the engine does not answer, or the coordinator does not start; both are told with what they wrote.
  // Once `in_hurry` holds, an engine that does not answer is not waited for.
  [[nodiscard]] static Result<std::unique_ptr<Cluster>> Start(const ClusterOptions& options,
                                                              const ClusterFolder& folder, Log log,
                                                              InHurry in_hurry = {});
  // Stop, if that was not called.
  ~Cluster();
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  [[nodiscard]] const ClusterRecord& record() const { return record_; }
  // How a client on this host reaches the coordinator.
  [[nodiscard]] CoordinatorTarget target() const;

  // Looks after coordinator and workers, if the last look was long enough ago. An engine or a coordinator that does not
  // answer is told and asked again later. kInternal: the coordinator ended too often.
  [[nodiscard]] Status Tick();
  // How often in a row workers ended before they had joined, or were not to be had.
  [[nodiscard]] int failures() const { return scaler_.failures(); }
  // Ends the coordinator if it is the cluster's own (its journal stays), and all workers.
  void Stop();

 private:
  Cluster(ClusterOptions options, ClusterFolder folder, Log log, InHurry in_hurry);
  [[nodiscard]] Status StartCoordinator();
  [[nodiscard]] Status LookAfterCoordinator();
  [[nodiscard]] Result<ClusterView> Look();
  void CarryOut(const ScalingDecision& decision);
  // A trouble that lasts is told once.
  void TellTrouble(const std::string& trouble);
  void WaitForPilots(std::chrono::milliseconds limit);

  ClusterOptions options_;
  ClusterFolder folder_;
  Log log_;
  InHurry in_hurry_;
  std::string instance_;
  ClusterRecord record_;
  std::string coordinator_program_;
  int port_ = 0;  // of the coordinator that was started
  std::optional<ChildProcess> coordinator_;
  int restarts_ = 0;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<Client> client_;
  Scaler scaler_;
  std::optional<std::chrono::steady_clock::time_point> looked_at_;
  std::string trouble_;
  bool stopped_ = false;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_H_
