#include "worker/segmentation/analysis_codec.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "common/base/little_endian.h"
#include "common/compression/artifact_format.h"
#include "common/compression/zstd_frame.h"
#include "common/job/artifact_versions.h"
#include "worker/segmentation/describe.h"
#include "worker/segmentation/label_codec.h"
#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

constexpr ArtifactFormat kFormat{.magic = "DFVA", .version = kViewAnalysisVersion, .name = "view analysis"};
constexpr std::size_t kHeaderSize = 24;  // width, height, segments, flags, lowest value and step of the prior
constexpr std::uint32_t kHasMatte = 1;
constexpr std::uint32_t kHasPrior = 2;
constexpr std::uint32_t kHasConfidence = 4;

using Channel = std::uint8_t Ycbcr::*;
constexpr Channel kChannels[] = {&Ycbcr::y, &Ycbcr::cb, &Ycbcr::cr};

// `value_at(x, y)`: bytes.
template <typename Values>
void AppendPlane(int width, int height, const Values& value_at, std::string& bytes) {
  const std::size_t start = bytes.size();
  bytes.resize(start + static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  char* differences = bytes.data() + start;
  for (int y = 0; y < height; ++y) {
    std::uint8_t left = 0;
    for (int x = 0; x < width; ++x) {
      const std::uint8_t value = value_at(x, y);
      *differences++ = static_cast<char>(value - left);
      left = value;
    }
  }
}

// `set(x, y, value)`. Requires width x height bytes in `plane`.
template <typename Set>
void ReadPlane(std::string_view plane, int width, int height, const Set& set) {
  std::size_t at = 0;
  for (int y = 0; y < height; ++y) {
    std::uint8_t left = 0;
    for (int x = 0; x < width; ++x) {
      left = static_cast<std::uint8_t>(left + static_cast<std::uint8_t>(plane[at++]));
      set(x, y, left);
    }
  }
}

bool HasMatte(const YcbcrImage& picture) {
  return std::any_of(picture.values().begin(), picture.values().end(),
                     [](const Ycbcr& pixel) { return pixel.matte != 0; });
}

void AppendPrior(const ViewPrior& prior, std::string& bytes) {
  if (prior.empty()) return;
  const int width = prior.codes.width();
  const int height = prior.codes.height();
  for (const int shift : {0, 8}) {
    AppendPlane(
        width, height, [&](int x, int y) { return static_cast<std::uint8_t>(prior.codes(x, y) >> shift); }, bytes);
  }
  if (prior.confidence.size() > 0)
    AppendPlane(
        width, height, [&](int x, int y) { return prior.confidence(x, y); }, bytes);
}

struct Header {
  int width = 0;
  int height = 0;
  SegmentIndex num_segments = 0;
  std::uint32_t flags = 0;
  float lowest = 0;
  float step = 0;

  [[nodiscard]] bool Has(std::uint32_t flag) const { return (flags & flag) != 0; }
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  // How many bytes of each pixel come before its label.
  [[nodiscard]] std::size_t planes() const {
    return std::size(kChannels) + (Has(kHasMatte) ? 1 : 0) + (Has(kHasPrior) ? 2 : 0) + (Has(kHasConfidence) ? 1 : 0);
  }
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
  const Header header{.width = static_cast<int>(width),
                      .height = static_cast<int>(height),
                      .num_segments = num_segments,
                      .flags = ReadU32(bytes, 12),
                      .lowest = std::bit_cast<float>(ReadU32(bytes, 16)),
                      .step = std::bit_cast<float>(ReadU32(bytes, 20))};
  constexpr std::uint32_t kAll = kHasMatte | kHasPrior | kHasConfidence;
  if ((header.flags & ~kAll) != 0 || (header.Has(kHasConfidence) && !header.Has(kHasPrior)))
    return Corrupt("flags are " + std::to_string(header.flags) + ", expected some of 1, 2 and, with 2, 4");
  if (!(header.lowest >= 0 && header.lowest <= kMostPriorValue && header.step >= 0 &&
        header.step <= kMostPriorValue / 65534))
    return Corrupt("the prior's values are out of range");
  return header;
}

Result<ViewAnalysis> ReadContent(std::string_view content, const Header& header) {
  ViewAnalysis analysis;
  analysis.picture = YcbcrImage(header.width, header.height);
  std::size_t offset = kHeaderSize;
  const auto read = [&](const auto& set) {
    ReadPlane(content.substr(offset, header.pixels()), header.width, header.height, set);
    offset += header.pixels();
  };
  const auto read_channel = [&](Channel channel) {
    read([&](int x, int y, std::uint8_t value) { analysis.picture(x, y).*channel = value; });
  };
  for (const Channel channel : kChannels) read_channel(channel);
  if (header.Has(kHasMatte)) read_channel(&Ycbcr::matte);
  ViewPrior& prior = analysis.prior;
  if (header.Has(kHasPrior)) {
    prior.lowest = header.lowest;
    prior.step = header.step;
    prior.codes = Grid<std::uint16_t>(header.width, header.height);
    for (const int shift : {0, 8}) {
      read([&](int x, int y, std::uint8_t value) {
        prior.codes(x, y) = static_cast<std::uint16_t>(prior.codes(x, y) | (value << shift));
      });
    }
  }
  if (header.Has(kHasConfidence)) {
    prior.confidence = Grid<std::uint8_t>(header.width, header.height);
    read([&](int x, int y, std::uint8_t value) { prior.confidence(x, y) = value; });
  }
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<SegmentIndex> labels,
                             ReadLabels(content.substr(offset), header.width, header.height, header.num_segments));
  DEPTHFARM_RETURN_IF_ERROR(ValidateLabels(labels));
  analysis.segments = DescribeSegments(std::move(labels), analysis.picture);
  if (analysis.segments.centers.size() != header.num_segments) {
    return Corrupt("label map has " + std::to_string(analysis.segments.centers.size()) + " segments, expected " +
                   std::to_string(header.num_segments));
  }
  if (!prior.empty()) prior.segments = DescribePrior(analysis.segments, prior);
  return analysis;
}

Result<ViewAnalysis> DecodeFrame(std::string_view frame) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string start, ReadZstdFrameStart(frame, kHeaderSize));
  DEPTHFARM_ASSIGN_OR_RETURN(const Header header, ReadHeader(start));
  const std::size_t before_labels = kHeaderSize + header.planes() * header.pixels();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string content,
                             ReadZstdFrame(frame, before_labels + LeastLabelBytes(header.pixels()),
                                           before_labels + MostLabelBytes(header.pixels())));
  return ReadContent(content, header);
}

}  // namespace

std::string EncodeAnalysis(const ViewAnalysis& analysis) {
  std::string content;
  const YcbcrImage& picture = analysis.picture;
  const ViewPrior& prior = analysis.prior;
  const bool has_matte = HasMatte(picture);
  const std::uint32_t flags = (has_matte ? kHasMatte : 0) | (prior.empty() ? 0 : kHasPrior) |
                              (prior.confidence.size() > 0 ? kHasConfidence : 0);
  content.reserve(kHeaderSize + 5 * picture.size());
  AppendU32(static_cast<std::uint32_t>(picture.width()), content);
  AppendU32(static_cast<std::uint32_t>(picture.height()), content);
  AppendU32(static_cast<std::uint32_t>(analysis.segments.num_segments()), content);
  AppendU32(flags, content);
  AppendU32(std::bit_cast<std::uint32_t>(prior.lowest), content);
  AppendU32(std::bit_cast<std::uint32_t>(prior.step), content);
  const auto append_channel = [&](Channel channel) {
    AppendPlane(
        picture.width(), picture.height(), [&](int x, int y) { return picture(x, y).*channel; }, content);
  };
  for (const Channel channel : kChannels) append_channel(channel);
  if (has_matte) append_channel(&Ycbcr::matte);
  AppendPrior(prior, content);
  std::vector<std::size_t> cuts;
  AppendLabels(analysis.segments.labels, content, cuts);
  return EncodeArtifact(kFormat, content, cuts);
}

Result<ViewAnalysis> DecodeAnalysis(std::string_view bytes) { return DecodeArtifact(kFormat, bytes, DecodeFrame); }

}  // namespace depthfarm
