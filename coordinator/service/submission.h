#ifndef DEPTHFARM_COORDINATOR_SERVICE_SUBMISSION_H_
#define DEPTHFARM_COORDINATOR_SERVICE_SUBMISSION_H_

#include <string>

#include "common/base/status.h"
#include "common/wire/envelope.h"
#include "coordinator/planning/job_plan.h"

namespace depthfarm {

// A client's job, checked and resolved: nothing of it is open, every bound holds.
// Errors: kInvalidArgument with what the submitter must change.
[[nodiscard]] Result<PlannedJob> PlanSubmission(const v1::SubmitJob& request, JobId id);

// "5 views 1024x768, 50,016 segments, 250 levels, n = 2 interleaved"; "1,200 virtual views, 1024x768".
[[nodiscard]] std::string Summary(const PlannedJob& planned);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_SUBMISSION_H_
