#ifndef DEPTHFARM_WORKER_EXECUTION_VIEWS_MANIFEST_H_
#define DEPTHFARM_WORKER_EXECUTION_VIEWS_MANIFEST_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// The text of views.json: of each view its file and digest, camera, frame and sources; of all, the sequence and the
// digest of the depth.json they were made from. A function of the job alone. kInvalidArgument when the lists are not
// equally long, a file is not its view's, or a name is not UTF-8.
[[nodiscard]] Result<std::string> FormatViewsManifest(const JobConfig& config, const std::vector<VirtualPicture>& views,
                                                      const std::vector<OutputFile>& files);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_VIEWS_MANIFEST_H_
