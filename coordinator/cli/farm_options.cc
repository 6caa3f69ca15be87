#include "coordinator/cli/farm_options.h"

#include <CLI/CLI.hpp>

namespace depthfarm {

void AddFarmOptions(CLI::App& app, FarmArguments& farm) {
  const char* group = "Farm";
  app.add_option("--coordinator", farm.coordinator, "Address of the coordinator")
      ->type_name("tcp://HOST:PORT")
      ->capture_default_str()
      ->envname("DEPTHFARM_COORDINATOR")
      ->group(group);
  app.add_option("--keys", farm.keys, "Folder with client.key and coordinator.pub, see depthfarm keygen")
      ->type_name("DIR")
      ->envname("DEPTHFARM_KEYS")
      ->group(group);
  app.add_flag("--insecure", farm.insecure, "No encryption and no keys: loopback addresses only")->group(group);
  app.add_option("--timeout", farm.timeout_seconds, "Seconds to wait for an answer of the coordinator")
      ->type_name("S")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str()
      ->group(group);
}

}  // namespace depthfarm
