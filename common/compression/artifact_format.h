#ifndef DEPTHFARM_COMMON_COMPRESSION_ARTIFACT_FORMAT_H_
#define DEPTHFARM_COMMON_COMPRESSION_ARTIFACT_FORMAT_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// A kind of artifact as bytes: four letters, its version (32 bits, little-endian), then one zstd frame (zstd_frame.h).
struct ArtifactFormat {
  std::string_view magic;  // four letters
  std::uint32_t version = 1;
  std::string_view name = "artifact";  // in messages
};

// An artifact with this content; `cuts` as AppendZstdFrame. Same content, same bytes.
[[nodiscard]] std::string EncodeArtifact(const ArtifactFormat& format, std::string_view content,
                                         std::span<const std::size_t> cuts = {});

// The zstd frame of an artifact, within `bytes`. kCorrupt: they begin otherwise; kIncompatible: another version.
[[nodiscard]] Result<std::string_view> FrameOfArtifact(const ArtifactFormat& format, std::string_view bytes);

// What `decode` makes of an artifact's frame, a Result. Errors: those of FrameOfArtifact and its own, after the
// format's name.
template <typename Decode>
[[nodiscard]] auto DecodeArtifact(const ArtifactFormat& format, std::string_view bytes, const Decode& decode)
    -> decltype(decode(bytes)) {
  const Result<std::string_view> frame = FrameOfArtifact(format, bytes);
  if (!frame.ok()) return frame.status().WithContext(std::string(format.name));
  auto decoded = decode(*frame);
  if (!decoded.ok()) return decoded.status().WithContext(std::string(format.name));
  return decoded;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_COMPRESSION_ARTIFACT_FORMAT_H_
