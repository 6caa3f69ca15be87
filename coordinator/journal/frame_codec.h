#ifndef DEPTHFARM_COORDINATOR_JOURNAL_FRAME_CODEC_H_
#define DEPTHFARM_COORDINATOR_JOURNAL_FRAME_CODEC_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "coordinator/scheduling/committed_frame.h"

namespace depthfarm {

// Little-endian: u32 files, then 32 bytes of SHA-256 and u64 bytes of each; u32 pictures, then 32 bytes each; u32
// bundles, 0 or 1, then 32 bytes of key, u64 bytes and 32 bytes of SHA-256.
[[nodiscard]] std::string EncodeFrame(const CommittedFrame& frame);
// kCorrupt for anything that EncodeFrame did not write.
[[nodiscard]] Result<CommittedFrame> DecodeFrame(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_JOURNAL_FRAME_CODEC_H_
