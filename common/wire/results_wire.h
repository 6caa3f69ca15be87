#ifndef DEPTHFARM_COMMON_WIRE_RESULTS_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_RESULTS_WIRE_H_

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

[[nodiscard]] v1::FrameResult ToProto(const FrameResult& result);

// Everything from a peer is checked: kInvalidArgument names field, value and bound.
[[nodiscard]] Result<FrameResult> FromProto(const v1::FrameResult& result);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_RESULTS_WIRE_H_
