#ifndef DEPTHFARM_COORDINATOR_CLI_ENGINE_SETUP_H_
#define DEPTHFARM_COORDINATOR_CLI_ENGINE_SETUP_H_

#include "common/base/status.h"
#include "coordinator/cli/arguments.h"
#include "coordinator/clusters/cluster_options.h"

namespace depthfarm {

// What the command line asks of a cluster, complete: engine, number of workers, absolute paths, the state folder's name
// (`--state`, or of the cluster's name). kInvalidArgument: options that are wrong or do not fit each other.
[[nodiscard]] Result<ClusterOptions> ResolveClusterOptions(const EngineArguments& arguments);

// That nothing was said about an engine but a cache, which a run on this machine has too. kInvalidArgument: it was.
[[nodiscard]] Status CheckNoEngineOptions(const EngineArguments& arguments);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_ENGINE_SETUP_H_
