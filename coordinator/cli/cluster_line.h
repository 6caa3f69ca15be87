#ifndef DEPTHFARM_COORDINATOR_CLI_CLUSTER_LINE_H_
#define DEPTHFARM_COORDINATOR_CLI_CLUSTER_LINE_H_

#include "coordinator/cli/arguments.h"

namespace CLI {
class App;
}

namespace depthfarm {

// Adds `cluster up`, `status`, `down` and what `up` starts to the app, and puts their arguments into `storage`.
void DefineCluster(CLI::App& app, CommandArguments& storage);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_CLUSTER_LINE_H_
