#ifndef DEPTHFARM_COORDINATOR_CLI_FARM_OPTIONS_H_
#define DEPTHFARM_COORDINATOR_CLI_FARM_OPTIONS_H_

#include <string>

namespace CLI {
class App;
}

namespace depthfarm {

// How to reach a coordinator.
struct FarmArguments {
  std::string coordinator = "tcp://127.0.0.1:7700";
  std::string keys;  // folder with client.key and coordinator.pub
  bool insecure = false;
  double timeout_seconds = 10;  // for one answer
};

// Adds --coordinator, --keys, --insecure and --timeout; the first two read DEPTHFARM_COORDINATOR and DEPTHFARM_KEYS
// too.
void AddFarmOptions(CLI::App& app, FarmArguments& farm);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_FARM_OPTIONS_H_
