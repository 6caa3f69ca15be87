#include "common/sequence/picture_format.h"

namespace depthfarm {
namespace {

std::uint64_t HalfSize(int size) { return (static_cast<std::uint64_t>(size) + 1) / 2; }

}  // namespace

bool ParseRawFormat(std::string_view name, PictureFormat* format) {
  for (int bits = 8; bits <= 16; ++bits) {
    const std::string ending = std::to_string(bits) + (bits == 8 ? "" : "le");
    if (name == "yuv420p" + ending || name == "gray" + ending) {
      format->kind = name.front() == 'y' ? PictureFormat::Kind::kYuv420 : PictureFormat::Kind::kYuv400;
      format->bits = bits;
      return true;
    }
  }
  return false;
}

std::string RawFormatName(const PictureFormat& format) {
  return (format.kind == PictureFormat::Kind::kYuv420 ? "yuv420p" : "gray") + std::to_string(format.bits) +
         (format.bits > 8 ? "le" : "");
}

std::uint64_t RawPictureBytes(const PictureFormat& format, int width, int height) {
  std::uint64_t samples = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (format.kind == PictureFormat::Kind::kYuv420) samples += 2 * HalfSize(width) * HalfSize(height);
  return samples * (format.bits > 8 ? 2 : 1);
}

}  // namespace depthfarm
