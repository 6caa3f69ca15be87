#ifndef DEPTHFARM_COORDINATOR_ENGINES_ENGINE_H_
#define DEPTHFARM_COORDINATOR_ENGINES_ENGINE_H_

#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// A worker process that an engine was asked for.
struct Pilot {
  std::string id;        // as the engine names it, unique among those of a cluster: "4711_3"
  bool running = false;  // false: it waits for a machine
  std::string host;      // where it runs
  std::string state;     // the engine's own words: "PENDING (Resources)"
  bool operator==(const Pilot&) const = default;
};

// Who owns the machines and starts workers on them: a batch system, ssh, this machine. Knows nothing of jobs. Workers
// end by themselves when the coordinator stops or drains them; that a pilot has ended shows in List.
class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  // Asks for `count` more workers. Errors: what the engine says: kInvalidArgument: it will never take such a request;
  // kUnavailable: it does not now.
  [[nodiscard]] virtual Status Launch(int count) = 0;
  // Those that wait or run.
  [[nodiscard]] virtual Result<std::vector<Pilot>> List() = 0;
  // A waiting one will not start; a running one gets SIGTERM, by which a worker hands its tasks back and leaves. Ids
  // that have ended are ignored.
  [[nodiscard]] virtual Status Cancel(const std::vector<std::string>& ids) = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_ENGINES_ENGINE_H_
