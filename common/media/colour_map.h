#ifndef DEPTHFARM_COMMON_MEDIA_COLOUR_MAP_H_
#define DEPTHFARM_COMMON_MEDIA_COLOUR_MAP_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/image/depth_code.h"
#include "common/image/picture.h"

namespace depthfarm {

// Depth in colours: linear in inverse depth over the range of `code`, the nearest red, the farthest blue (OpenCV's
// TURBO map), no depth black.
[[nodiscard]] Result<RgbImage> ColourMapped(const DepthMap& depth, const DepthCode& code);

// A picture as it looks: full-range BT.601 to R'G'B', rounded and clamped.
[[nodiscard]] RgbImage ToRgb(const YcbcrImage& picture);

// Pictures side by side, `columns` a row, `gap` white pixels between them; each at the top left of a cell as large as
// the largest picture. kInvalidArgument: no picture, columns < 1, gap < 0, or a sheet of more than 2^28 pixels.
[[nodiscard]] Result<RgbImage> ContactSheet(const std::vector<RgbImage>& pictures, int columns, int gap);

// Box average by `factor` >= 1 (floor of the size), for sheets of large pictures.
[[nodiscard]] RgbImage Shrunk(const RgbImage& picture, int factor);

// 8-bit colour PNG.
[[nodiscard]] Result<std::string> EncodeRgbPng(const RgbImage& picture);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_COLOUR_MAP_H_
