#ifndef DEPTHFARM_WORKER_SERVICE_DEATH_NOTICE_H_
#define DEPTHFARM_WORKER_SERVICE_DEATH_NOTICE_H_

#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/service/worker_service.h"

namespace depthfarm {

// Tells the coordinator of a worker of these options (Identify) that its process ended without a goodbye, and what it
// was computing: `how` continues "the worker ", `last_words` is the end of its stderr. Returns when the message has
// left, or after a few seconds. Errors: keys that cannot be read, an endpoint that is none; that the coordinator is
// away is not found out.
[[nodiscard]] Status SendDeathNotice(const WorkerOptions& options, const std::string& how, const TaskLog& last_words);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_DEATH_NOTICE_H_
