#ifndef DEPTHFARM_COMMON_QUALITY_MASKS_H_
#define DEPTHFARM_COMMON_QUALITY_MASKS_H_

#include <cstdint>

#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// Which pixels count: 0 = no, anything else = yes.
using PixelMask = Grid<std::uint8_t>;

// Every pixel within `radius` pixels (in x and in y: a square) of a set one. radius >= 0.
[[nodiscard]] PixelMask Dilated(const PixelMask& mask, int radius);

// 1 where `mask` is 0 and the other way round.
[[nodiscard]] PixelMask Inverted(const PixelMask& mask);

// Pixels whose zone is `zone`.
[[nodiscard]] PixelMask PixelsOfZone(const ZoneMap& zones, std::uint8_t zone);

// Pixels less than `width` pixels from the picture's border.
[[nodiscard]] PixelMask BorderPixels(int picture_width, int picture_height, int width);

// Share of set pixels, 0..1; 0 of an empty mask.
[[nodiscard]] double ShareSet(const PixelMask& mask);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_MASKS_H_
