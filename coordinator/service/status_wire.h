#ifndef DEPTHFARM_COORDINATOR_SERVICE_STATUS_WIRE_H_
#define DEPTHFARM_COORDINATOR_SERVICE_STATUS_WIRE_H_

#include <string>

#include "common/wire/envelope.h"
#include "coordinator/scheduling/snapshot.h"
#include "coordinator/service/worker_sessions.h"

namespace depthfarm {

[[nodiscard]] v1::JobState ToProto(JobState state);

// `now` ends the elapsed time of a job that still runs.
[[nodiscard]] v1::JobStatus StatusToProto(const JobSnapshot& job, const std::string& summary, TimePoint now);
// `session` may be null.
[[nodiscard]] v1::WorkerStatus StatusToProto(const WorkerSnapshot& worker, const WorkerSession* session, TimePoint now);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_STATUS_WIRE_H_
