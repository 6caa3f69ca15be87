#ifndef DEPTHFARM_COMMON_WIRE_JOB_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_JOB_WIRE_H_

#include "common/base/status.h"
#include "common/job/estimation_params.h"
#include "common/job/task_spec.h"
#include "depthfarm/v1/job.pb.h"

namespace depthfarm {

[[nodiscard]] v1::EstimationParams ToProto(const EstimationParams& params);
[[nodiscard]] v1::JobConfig ToProto(const JobConfig& config);

// Everything from a peer is checked (EstimationParams::Validate, ValidateCamera, sizes, ranges, neighbours, paths):
// kInvalidArgument names field, value and bound. The resolved job of an accepted JobConfig is one that ResolveJob could
// have made: Levels() is safe, neighbours are other views, block counts fit.
[[nodiscard]] Result<EstimationParams> FromProto(const v1::EstimationParams& params);
[[nodiscard]] Result<JobConfig> FromProto(const v1::JobConfig& config);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_JOB_WIRE_H_
