#include "worker/estimation/label_field_codec.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/base/little_endian.h"
#include "common/compression/artifact_format.h"
#include "common/compression/zstd_frame.h"

namespace depthfarm {
namespace {

// A frame of: number of views; per view the number of segments, the differences of successive levels (low bytes, then
// high bytes: they compress apart), the unchanged flags.
constexpr ArtifactFormat kFormat{.magic = "DFLF", .version = 1, .name = "label field"};
constexpr std::uint32_t kMaxViews = 1024;
constexpr std::size_t kMaxContent = std::size_t{1} << 31;

void AppendView(const ViewLabels& view, std::string& content) {
  AppendU32(static_cast<std::uint32_t>(view.levels.size()), content);
  for (const int shift : {0, 8}) {
    Level last = 0;
    for (const Level level : view.levels) {
      content.push_back(static_cast<char>(static_cast<Level>(level - last) >> shift & 0xFF));
      last = level;
    }
  }
  for (const std::uint8_t unchanged : view.unchanged) content.push_back(static_cast<char>(unchanged));
}

// Reads one view at `offset` and moves it on.
Result<ViewLabels> ReadView(std::string_view content, std::size_t& offset) {
  if (content.size() - offset < 4) return Corrupt("it ends before the number of segments");
  const std::size_t segments = ReadU32(content, offset);
  offset += 4;
  if (segments == 0 || (content.size() - offset) / 3 < segments) {
    return Corrupt("it says " + std::to_string(segments) + " segments and has no room for them");
  }
  ViewLabels view;
  view.levels.resize(segments);
  view.unchanged.resize(segments);
  Level last = 0;
  for (std::size_t s = 0; s < segments; ++s) {
    const auto low = static_cast<std::uint8_t>(content[offset + s]);
    const auto high = static_cast<std::uint8_t>(content[offset + segments + s]);
    last = static_cast<Level>(last + low + (high << 8));
    view.levels[s] = last;
    const auto unchanged = static_cast<std::uint8_t>(content[offset + 2 * segments + s]);
    if (unchanged > 1) return Corrupt("an unchanged flag is " + std::to_string(unchanged) + ", expected 0 or 1");
    view.unchanged[s] = unchanged;
  }
  offset += 3 * segments;
  return view;
}

Result<LabelField> DecodeFrame(std::string_view frame) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string content, ReadZstdFrame(frame, 4, kMaxContent));
  const std::uint32_t num_views = ReadU32(content, 0);
  if (num_views == 0 || num_views > kMaxViews) {
    return Corrupt(std::to_string(num_views) + " views, expected 1 to " + std::to_string(kMaxViews));
  }
  LabelField field;
  std::size_t offset = 4;
  for (std::uint32_t view = 0; view < num_views; ++view) {
    DEPTHFARM_ASSIGN_OR_RETURN(ViewLabels labels, ReadView(content, offset));
    field.views.push_back(std::move(labels));
  }
  if (offset != content.size()) return Corrupt("bytes follow its last view");
  return field;
}

}  // namespace

std::string EncodeLabelField(const LabelField& field) {
  std::string content;
  AppendU32(static_cast<std::uint32_t>(field.views.size()), content);
  for (const ViewLabels& view : field.views) AppendView(view, content);
  return EncodeArtifact(kFormat, content);
}

Result<LabelField> DecodeLabelField(std::string_view bytes) { return DecodeArtifact(kFormat, bytes, DecodeFrame); }

}  // namespace depthfarm
