#ifndef DEPTHFARM_COMMON_COMPRESSION_ARTIFACT_FORMAT_H_
#define DEPTHFARM_COMMON_COMPRESSION_ARTIFACT_FORMAT_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// A kind of artifact as bytes: four letters, its version (32 bits, little-endian), then one zstd frame (zstd_frame.h).
struct ArtifactFormat {
  std::string_view magic;  // four letters
  std::uint32_t version = 1;
};

// An artifact with this content. Same content, same bytes.
[[nodiscard]] std::string EncodeArtifact(const ArtifactFormat& format, std::string_view content);

// The zstd frame of an artifact, within `bytes`. kCorrupt: they begin otherwise; kIncompatible: another version.
[[nodiscard]] Result<std::string_view> FrameOfArtifact(const ArtifactFormat& format, std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_COMPRESSION_ARTIFACT_FORMAT_H_
