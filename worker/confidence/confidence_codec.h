#ifndef DEPTHFARM_WORKER_CONFIDENCE_CONFIDENCE_CODEC_H_
#define DEPTHFARM_WORKER_CONFIDENCE_CONFIDENCE_CODEC_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "worker/confidence/confidence.h"

namespace depthfarm {

// A confidence map as an artifact: versioned header, then size and codes, zstd with content checksum. Same map, same
// bytes.
[[nodiscard]] std::string EncodeConfidence(const ConfidenceMap& map);

// The map again. kCorrupt, with the reason, for anything that is not whole; kIncompatible: another version. Bounded
// allocation on hostile input.
[[nodiscard]] Result<ConfidenceMap> DecodeConfidence(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_CONFIDENCE_CONFIDENCE_CODEC_H_
