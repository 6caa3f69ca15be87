#ifndef DEPTHFARM_COORDINATOR_FORECAST_CRITICAL_PATH_H_
#define DEPTHFARM_COORDINATOR_FORECAST_CRITICAL_PATH_H_

#include <vector>

#include "coordinator/forecast/task_graph.h"

namespace depthfarm {

// The chain of tasks, each needing the one before, that takes longest: however many workers there are, the job takes no
// less. In the order they run; of chains that are equally long the one through the earliest tasks.
struct CriticalPath {
  std::vector<TaskGraph::Index> tasks;
  double seconds = 0;
};
[[nodiscard]] CriticalPath FindCriticalPath(const TaskGraph& graph);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_FORECAST_CRITICAL_PATH_H_
