#include "common/compression/artifact_format.h"

#include <cstddef>

#include "common/base/little_endian.h"
#include "common/compression/zstd_frame.h"

namespace depthfarm {
namespace {

constexpr std::size_t kVersionBytes = 4;

}  // namespace

std::string EncodeArtifact(const ArtifactFormat& format, std::string_view content, std::span<const std::size_t> cuts) {
  std::string bytes(format.magic);
  AppendU32(format.version, bytes);
  AppendZstdFrame(content, bytes, cuts);
  return bytes;
}

Result<std::string_view> FrameOfArtifact(const ArtifactFormat& format, std::string_view bytes) {
  const std::size_t prefix = format.magic.size() + kVersionBytes;
  if (bytes.size() < prefix || !bytes.starts_with(format.magic))
    return Corrupt("does not begin with " + std::string(format.magic) + " and a version");
  if (const std::uint32_t version = ReadU32(bytes, format.magic.size()); version != format.version) {
    return Status(ErrorCode::kIncompatible,
                  "version is " + std::to_string(version) + ", expected " + std::to_string(format.version));
  }
  return bytes.substr(prefix);
}

}  // namespace depthfarm
