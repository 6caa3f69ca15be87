#ifndef DEPTHFARM_COMMON_WIRE_RENDER_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_RENDER_WIRE_H_

#include <vector>

#include "common/base/status.h"
#include "common/job/virtual_picture.h"
#include "depthfarm/v1/job.pb.h"

namespace depthfarm {

// Of one job: some 350 bytes each in a message of at most 64 MiB.
inline constexpr int kMaxVirtualPictures = 100'000;

[[nodiscard]] v1::VirtualPicture ToProto(const VirtualPicture& view);
[[nodiscard]] v1::RenderSource ToProto(const RenderSource& source);

// Everything from a peer is checked: kInvalidArgument names the view, field, value and bound. Numbers of a list are
// distinct.
[[nodiscard]] Result<std::vector<VirtualPicture>> ViewsFromProto(
    const google::protobuf::RepeatedPtrField<v1::VirtualPicture>& views);
[[nodiscard]] Result<RenderSource> FromProto(const v1::RenderSource& source);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_RENDER_WIRE_H_
