#ifndef DEPTHFARM_WORKER_REFINEMENT_REFINED_VIEW_CODEC_H_
#define DEPTHFARM_WORKER_REFINEMENT_REFINED_VIEW_CODEC_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// A refined view as an artifact: versioned header, then kept flags, planes and the map of planes, zstd with content
// checksum. Same view, same bytes.
[[nodiscard]] std::string EncodeRefinedView(const RefinedView& view);

// The view, to the bit. kCorrupt, with the reason, for anything that is not whole or no depth (planes that are not
// finite, pixels without a plane); kIncompatible: another version. Bounded allocation on hostile input.
[[nodiscard]] Result<RefinedView> DecodeRefinedView(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_REFINED_VIEW_CODEC_H_
