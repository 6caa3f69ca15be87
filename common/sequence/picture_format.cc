#include "common/sequence/picture_format.h"

#include <array>
#include <utility>

namespace depthfarm {
namespace {

using Kind = PictureFormat::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 4> kPlanes = {
    {{"yuv420p", Kind::kYuv420}, {"yuv422p", Kind::kYuv422}, {"yuv444p", Kind::kYuv444}, {"gray", Kind::kYuv400}}};

std::string Ending(int bits) { return std::to_string(bits) + (bits > 8 ? "le" : ""); }

}  // namespace

bool ParseRawFormat(std::string_view name, PictureFormat* format) {
  for (const auto& [planes, kind] : kPlanes) {
    if (!name.starts_with(planes)) continue;
    for (int bits = 8; bits <= 16; ++bits) {
      if (name.substr(planes.size()) != Ending(bits)) continue;
      format->kind = kind;
      format->bits = bits;
      return true;
    }
  }
  return false;
}

std::string RawFormatName(const PictureFormat& format) {
  for (const auto& [planes, kind] : kPlanes)
    if (kind == format.kind) return std::string(planes) + Ending(format.bits);
  return "no raw format";
}

ChromaShift ChromaShiftOf(PictureFormat::Kind kind) {
  return {kind == Kind::kYuv444 ? 0 : 1, kind == Kind::kYuv420 ? 1 : 0};
}

std::uint64_t RawPictureBytes(const PictureFormat& format, int width, int height) {
  const auto plane = [&](ChromaShift shift) {
    const auto samples = [](int pixels, int by) { return (static_cast<std::uint64_t>(pixels) + by) >> by; };
    return samples(width, shift.x) * samples(height, shift.y);
  };
  std::uint64_t samples = plane({});
  if (format.kind != Kind::kYuv400) samples += 2 * plane(ChromaShiftOf(format.kind));
  return samples * (format.bits > 8 ? 2 : 1);
}

}  // namespace depthfarm
