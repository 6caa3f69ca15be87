#ifndef DEPTHFARM_COORDINATOR_SERVICE_LOGS_WIRE_H_
#define DEPTHFARM_COORDINATOR_SERVICE_LOGS_WIRE_H_

#include "common/base/status.h"
#include "common/wire/envelope.h"
#include "coordinator/service/attempt_records.h"

namespace depthfarm {

// One answer's worth of the attempts that are asked for, of a job that was submitted then: at most 1000, and 4 MiB
// beyond the first. kInvalidArgument: the request's task names none.
[[nodiscard]] Result<v1::JobLogs> LogsToProto(const AttemptRecords& records, const v1::GetJobLogs& request,
                                              TimePoint submitted, TimePoint now);

// Adds the last failed attempts of a task, with the ends of their logs, so that all together stay below 50 KiB.
void AddFailedAttempts(const AttemptRecords& records, const TaskId& task, TimePoint submitted, TimePoint now,
                       v1::JobStatus& status);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_LOGS_WIRE_H_
