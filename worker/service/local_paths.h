#ifndef DEPTHFARM_WORKER_SERVICE_LOCAL_PATHS_H_
#define DEPTHFARM_WORKER_SERVICE_LOCAL_PATHS_H_

#include "common/files/path_map.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// What a job or task names, under the paths of this host: the only place where a worker's path map counts. No artifact
// and no manifest names a path, so results are the same with any map. Staging folders follow their output folder; the
// pictures of a rendering job follow its sequence file.
[[nodiscard]] JobConfig WithLocalPaths(JobConfig config, const PathMap& map);
[[nodiscard]] TaskSpec WithLocalPaths(TaskSpec spec, const PathMap& map);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_LOCAL_PATHS_H_
