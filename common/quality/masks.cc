#include "common/quality/masks.h"

#include <algorithm>

namespace depthfarm {

PixelMask Dilated(const PixelMask& mask, int radius) {
  const int width = mask.width();
  const int height = mask.height();
  PixelMask rows(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (mask(x, y) == 0) continue;
      std::uint8_t* row = rows.row(y);
      std::fill(row + std::max(x - radius, 0), row + std::min(x + radius, width - 1) + 1, std::uint8_t{1});
    }
  }
  PixelMask result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int near = std::max(y - radius, 0); near <= std::min(y + radius, height - 1); ++near) {
      for (int x = 0; x < width; ++x) result(x, y) |= rows(x, near);
    }
  }
  return result;
}

PixelMask Inverted(const PixelMask& mask) {
  PixelMask result = mask;
  for (std::uint8_t& value : result.values()) value = value == 0 ? 1 : 0;
  return result;
}

PixelMask PixelsOfZone(const ZoneMap& zones, std::uint8_t zone) {
  PixelMask result = zones;
  for (std::uint8_t& value : result.values()) value = value == zone ? 1 : 0;
  return result;
}

PixelMask BorderPixels(int picture_width, int picture_height, int width) {
  PixelMask result(picture_width, picture_height);
  for (int y = 0; y < picture_height; ++y) {
    for (int x = 0; x < picture_width; ++x) {
      const int distance = std::min({x, y, picture_width - 1 - x, picture_height - 1 - y});
      result(x, y) = distance < width ? 1 : 0;
    }
  }
  return result;
}

double ShareSet(const PixelMask& mask) {
  if (mask.empty()) return 0;
  const auto set = std::count_if(mask.values().begin(), mask.values().end(), [](std::uint8_t v) { return v != 0; });
  return static_cast<double>(set) / static_cast<double>(mask.size());
}

}  // namespace depthfarm
