#ifndef DEPTHFARM_COORDINATOR_CLUSTERS_SCALER_H_
#define DEPTHFARM_COORDINATOR_CLUSTERS_SCALER_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/engines/engine.h"

namespace depthfarm {

struct ScalerOptions {
  std::string cluster = {};  // whose workers are its own (PilotOfWorker)
  int min_workers = 1;
  int max_workers = 1;
  int slots_per_worker = 1;
  std::chrono::milliseconds idle{120'000};  // a worker that is not needed leaves after so long without a task
  std::chrono::milliseconds settle{5'000};  // a waiting pilot that is not needed is cancelled after so long
};

// A worker as the coordinator tells.
struct ClusterWorker {
  std::string name;
  bool busy = false;
  bool draining = false;
};

// What there is at one moment.
struct ClusterView {
  std::uint64_t wanted_slots = 0;  // that would not be idle
  std::vector<Pilot> pilots;       // that wait or run
  std::vector<ClusterWorker> workers;
};

// What must be done now.
struct ScalingDecision {
  int launch = 0;
  std::vector<std::string> cancel;  // pilots
  std::vector<std::string> drain;   // workers
  // Pilots that ended without a worker of theirs having joined; how many more were gone before they were seen.
  std::vector<std::string> failed;
  int vanished = 0;
  // After failures: nothing is launched before that long from now.
  std::optional<std::chrono::milliseconds> pause;
};

// How many workers a cluster has: as many as there is work for, within bounds. Grows at once; shrinks by the workers
// that were idle longest, and of pilots that only wait for a machine the newest first. Pilots that end before their
// workers join (a wrong path, keys that are not there) are not replaced at once but after 5 s, 10 s, ... 5 min. Pure:
// time comes with each call.
class Scaler {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit Scaler(ScalerOptions options) : options_(std::move(options)) {}
  [[nodiscard]] ScalingDecision Decide(const ClusterView& view, TimePoint now);
  // The engine did not take what the last decision said to launch. Returns how long the next one waits.
  std::chrono::milliseconds LaunchFailed(TimePoint now);

  // In a row, since a worker joined last.
  [[nodiscard]] int failures() const { return failures_; }

 private:
  [[nodiscard]] int Target(std::uint64_t wanted_slots) const;
  // Finds pilots that ended since the last call without having joined.
  void FindFailed(const ClusterView& view, ScalingDecision& decision);
  std::chrono::milliseconds Pause(TimePoint now);
  void Shrink(const ClusterView& view, int surplus, TimePoint now, ScalingDecision& decision);

  ScalerOptions options_;
  std::map<std::string, TimePoint> idle_since_;  // by worker
  std::optional<TimePoint> surplus_since_;
  std::map<std::string, bool> pilots_;  // of the last view: whether a worker of theirs joined
  int launched_ = 0;                    // by the last decision
  int failures_ = 0;                    // in a row
  TimePoint launch_after_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLUSTERS_SCALER_H_
