#include "worker/refinement/refined_view_codec.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/little_endian.h"
#include "common/compression/artifact_format.h"
#include "common/compression/zstd_frame.h"
#include "common/job/artifact_versions.h"
#include "worker/segmentation/label_codec.h"
#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

// A frame of: width, height, segments, planes; the kept flags; a, b, c of each plane, first the lowest byte of all,
// last the highest (they compress apart); the plane of each pixel (label_codec.h).
constexpr ArtifactFormat kFormat{.magic = "DFRV", .version = kRefinedViewVersion, .name = "refined view"};
constexpr std::size_t kHeaderSize = 16;
constexpr std::size_t kPlaneBytes = 12;

using Coefficient = float SlantedPlane::*;
constexpr Coefficient kCoefficients[] = {&SlantedPlane::a, &SlantedPlane::b, &SlantedPlane::c};

struct Header {
  int width = 0;
  int height = 0;
  std::uint32_t segments = 0;
  std::uint32_t planes = 0;
};

Result<Header> ReadHeader(std::string_view bytes) {
  const std::uint32_t width = ReadU32(bytes, 0);
  const std::uint32_t height = ReadU32(bytes, 4);
  const std::uint32_t segments = ReadU32(bytes, 8);
  const std::uint32_t planes = ReadU32(bytes, 12);
  const Status size = ValidatePictureSize(width, height);
  if (!size.ok()) return Corrupt(size.message());
  // Each plane beyond the segments' is that of some pixel.
  const std::uint64_t pixels = std::uint64_t{width} * height;
  if (segments < 1 || segments > pixels || planes < segments || planes - segments > pixels) {
    return Corrupt(std::to_string(segments) + " segments and " + std::to_string(planes) + " planes do not fit " +
                   std::to_string(pixels) + " pixels");
  }
  return Header{static_cast<int>(width), static_cast<int>(height), segments, planes};
}

Status ReadPlanes(std::string_view bytes, std::vector<SlantedPlane>& planes) {
  std::size_t offset = 0;
  for (const Coefficient coefficient : kCoefficients) {
    std::vector<std::uint32_t> bits(planes.size());
    for (unsigned shift = 0; shift < 32; shift += 8)
      for (std::uint32_t& value : bits) value |= std::uint32_t{static_cast<std::uint8_t>(bytes[offset++])} << shift;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const auto value = std::bit_cast<float>(bits[i]);
      if (!std::isfinite(value)) return Corrupt("plane " + std::to_string(i) + " is not finite");
      planes[i].*coefficient = value;
    }
  }
  return {};
}

Result<RefinedView> ReadContent(std::string_view content, const Header& header) {
  RefinedView view;
  view.kept.resize(header.segments);
  for (std::size_t s = 0; s < view.kept.size(); ++s) {
    const auto kept = static_cast<std::uint8_t>(content[kHeaderSize + s]);
    if (kept > 1) return Corrupt("a kept flag is " + std::to_string(kept) + ", expected 0 or 1");
    view.kept[s] = kept;
  }
  view.planes.resize(header.planes);
  const std::size_t planes_at = kHeaderSize + header.segments;
  DEPTHFARM_RETURN_IF_ERROR(ReadPlanes(content.substr(planes_at), view.planes));
  DEPTHFARM_ASSIGN_OR_RETURN(view.plane_of_pixel, ReadLabels(content.substr(planes_at + kPlaneBytes * header.planes),
                                                             header.width, header.height, header.planes));
  return view;
}

Result<RefinedView> DecodeFrame(std::string_view frame) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string start, ReadZstdFrameStart(frame, kHeaderSize));
  DEPTHFARM_ASSIGN_OR_RETURN(const Header header, ReadHeader(start));
  const std::size_t pixels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  const std::size_t before_labels = kHeaderSize + header.segments + kPlaneBytes * header.planes;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string content, ReadZstdFrame(frame, before_labels + LeastLabelBytes(pixels),
                                                                      before_labels + MostLabelBytes(pixels)));
  return ReadContent(content, header);
}

}  // namespace

std::string EncodeRefinedView(const RefinedView& view) {
  std::string content;
  content.reserve(kHeaderSize + view.kept.size() + kPlaneBytes * view.planes.size() + view.plane_of_pixel.size());
  AppendU32(static_cast<std::uint32_t>(view.plane_of_pixel.width()), content);
  AppendU32(static_cast<std::uint32_t>(view.plane_of_pixel.height()), content);
  AppendU32(static_cast<std::uint32_t>(view.kept.size()), content);
  AppendU32(static_cast<std::uint32_t>(view.planes.size()), content);
  content.append(view.kept.begin(), view.kept.end());
  for (const Coefficient coefficient : kCoefficients) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      for (const SlantedPlane& plane : view.planes)
        content.push_back(static_cast<char>(std::bit_cast<std::uint32_t>(plane.*coefficient) >> shift & 0xFFU));
    }
  }
  std::vector<std::size_t> cuts;
  AppendLabels(view.plane_of_pixel, content, cuts);
  return EncodeArtifact(kFormat, content, cuts);
}

Result<RefinedView> DecodeRefinedView(std::string_view bytes) { return DecodeArtifact(kFormat, bytes, DecodeFrame); }

}  // namespace depthfarm
