#ifndef DEPTHFARM_COMMON_WIRE_SEQUENCE_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_SEQUENCE_WIRE_H_

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/sequence/sequence.h"
#include "depthfarm/v1/job.pb.h"

namespace depthfarm {

// Supplied depth and ground truth stay with the submitter: estimation does not use them.
[[nodiscard]] v1::Camera ToProto(const Camera& camera);
[[nodiscard]] v1::PictureFormat ToProto(const PictureFormat& format);
[[nodiscard]] v1::PriorFormat ToProto(const PriorFormat& format);
[[nodiscard]] v1::Sequence ToProto(const Sequence& sequence);

// Everything from a peer is checked: kInvalidArgument names camera, field, value and bound.
[[nodiscard]] Result<Camera> FromProto(const v1::Camera& camera);
[[nodiscard]] Result<PictureFormat> FromProto(const v1::PictureFormat& format);
[[nodiscard]] Result<PriorFormat> FromProto(const v1::PriorFormat& format);
[[nodiscard]] Result<Sequence> FromProto(const v1::Sequence& sequence);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_SEQUENCE_WIRE_H_
