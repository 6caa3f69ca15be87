#include "worker/confidence/confidence_codec.h"

#include <cstddef>
#include <cstdint>

#include "common/base/little_endian.h"
#include "common/compression/artifact_format.h"
#include "common/compression/zstd_frame.h"
#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

// A frame of: width, height; the low bytes of all codes, then the high ones.
constexpr ArtifactFormat kFormat{.magic = "DFCM", .version = 1, .name = "confidence map"};
constexpr std::size_t kHeaderSize = 8;

Result<ConfidenceMap> DecodeFrame(std::string_view frame) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string start, ReadZstdFrameStart(frame, kHeaderSize));
  const std::uint32_t width = ReadU32(start, 0);
  const std::uint32_t height = ReadU32(start, 4);
  if (const Status size = ValidatePictureSize(width, height); !size.ok()) return Corrupt(size.message());
  const std::size_t pixels = std::size_t{width} * height;
  const std::size_t bytes = kHeaderSize + 2 * pixels;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string content, ReadZstdFrame(frame, bytes, bytes));
  ConfidenceMap map{Grid<std::uint16_t>(static_cast<int>(width), static_cast<int>(height))};
  for (std::size_t i = 0; i < pixels; ++i) {
    const unsigned low = static_cast<std::uint8_t>(content[kHeaderSize + i]);
    const unsigned high = static_cast<std::uint8_t>(content[kHeaderSize + pixels + i]);
    map.codes.values()[i] = static_cast<std::uint16_t>(low | high << 8U);
  }
  return map;
}

}  // namespace

std::string EncodeConfidence(const ConfidenceMap& map) {
  std::string content;
  content.reserve(kHeaderSize + 2 * map.codes.size());
  AppendU32(static_cast<std::uint32_t>(map.codes.width()), content);
  AppendU32(static_cast<std::uint32_t>(map.codes.height()), content);
  for (const unsigned shift : {0U, 8U})
    for (const std::uint16_t code : map.codes.values()) content.push_back(static_cast<char>(code >> shift & 0xFFU));
  return EncodeArtifact(kFormat, content);
}

Result<ConfidenceMap> DecodeConfidence(std::string_view bytes) { return DecodeArtifact(kFormat, bytes, DecodeFrame); }

}  // namespace depthfarm
