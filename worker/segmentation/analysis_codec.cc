#include "worker/segmentation/analysis_codec.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/base/little_endian.h"
#include "common/compression/artifact_format.h"
#include "common/compression/zstd_frame.h"
#include "worker/segmentation/describe.h"
#include "worker/segmentation/label_codec.h"
#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

constexpr ArtifactFormat kFormat{.magic = "DFVA", .version = 1, .name = "view analysis"};
constexpr std::size_t kHeaderSize = 12;  // width, height, segments

using Channel = std::uint8_t Ycbcr::*;
constexpr Channel kChannels[] = {&Ycbcr::y, &Ycbcr::cb, &Ycbcr::cr};

void AppendPlane(const YcbcrImage& picture, Channel channel, std::string& bytes) {
  for (int y = 0; y < picture.height(); ++y) {
    std::uint8_t left = 0;
    for (int x = 0; x < picture.width(); ++x) {
      const std::uint8_t value = picture(x, y).*channel;
      bytes.push_back(static_cast<char>(value - left));
      left = value;
    }
  }
}

// Requires picture.size() bytes in `plane`.
void ReadPlane(std::string_view plane, Channel channel, YcbcrImage& picture) {
  for (int y = 0; y < picture.height(); ++y) {
    std::uint8_t left = 0;
    for (int x = 0; x < picture.width(); ++x) {
      left = static_cast<std::uint8_t>(left + static_cast<std::uint8_t>(plane[picture.Index(x, y)]));
      picture(x, y).*channel = left;
    }
  }
}

struct Header {
  int width = 0;
  int height = 0;
  SegmentIndex num_segments = 0;
};

Result<Header> ReadHeader(std::string_view bytes) {
  const std::uint32_t width = ReadU32(bytes, 0);
  const std::uint32_t height = ReadU32(bytes, 4);
  const std::uint32_t num_segments = ReadU32(bytes, 8);
  const Status size = ValidatePictureSize(width, height);
  if (!size.ok()) return Corrupt(size.message());
  if (num_segments < 1 || num_segments > std::uint64_t{width} * height) {
    return Corrupt("number of segments is " + std::to_string(num_segments) + ", expected 1 to the " +
                   std::to_string(std::uint64_t{width} * height) + " pixels");
  }
  return Header{static_cast<int>(width), static_cast<int>(height), num_segments};
}

Result<ViewAnalysis> ReadContent(std::string_view content, const Header& header) {
  ViewAnalysis analysis;
  analysis.picture = YcbcrImage(header.width, header.height);
  const std::size_t pixels = analysis.picture.size();
  std::size_t offset = kHeaderSize;
  for (const Channel channel : kChannels) {
    ReadPlane(content.substr(offset, pixels), channel, analysis.picture);
    offset += pixels;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<SegmentIndex> labels,
                             ReadLabels(content.substr(offset), header.width, header.height, header.num_segments));
  DEPTHFARM_RETURN_IF_ERROR(ValidateLabels(labels));
  analysis.segments = DescribeSegments(std::move(labels), analysis.picture);
  if (analysis.segments.centers.size() != header.num_segments) {
    return Corrupt("label map has " + std::to_string(analysis.segments.centers.size()) + " segments, expected " +
                   std::to_string(header.num_segments));
  }
  return analysis;
}

Result<ViewAnalysis> DecodeFrame(std::string_view frame) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string start, ReadZstdFrameStart(frame, kHeaderSize));
  DEPTHFARM_ASSIGN_OR_RETURN(const Header header, ReadHeader(start));
  const std::size_t pixels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  const std::size_t least = kHeaderSize + 4 * pixels;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string content,
                             ReadZstdFrame(frame, least, least + kMaxExplicitLabelBytes * pixels));
  return ReadContent(content, header);
}

}  // namespace

std::string EncodeAnalysis(const ViewAnalysis& analysis) {
  std::string content;
  content.reserve(kHeaderSize + 5 * analysis.picture.size());
  AppendU32(static_cast<std::uint32_t>(analysis.picture.width()), content);
  AppendU32(static_cast<std::uint32_t>(analysis.picture.height()), content);
  AppendU32(static_cast<std::uint32_t>(analysis.segments.num_segments()), content);
  for (const Channel channel : kChannels) AppendPlane(analysis.picture, channel, content);
  AppendLabels(analysis.segments.labels, content);

  return EncodeArtifact(kFormat, content);
}

Result<ViewAnalysis> DecodeAnalysis(std::string_view bytes) { return DecodeArtifact(kFormat, bytes, DecodeFrame); }

}  // namespace depthfarm
