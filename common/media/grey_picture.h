#ifndef DEPTHFARM_COMMON_MEDIA_GREY_PICTURE_H_
#define DEPTHFARM_COMMON_MEDIA_GREY_PICTURE_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/grid.h"

namespace depthfarm {

// Samples of a grey image file as stored: masks, zones, disparity, depth codes.
struct GreyPicture {
  Grid<std::uint16_t> values;
  int bits = 8;  // 8 or 16
};

// Errors (kInvalidArgument, without the path): not decodable, or coloured (a palette of greys counts as grey).
[[nodiscard]] Result<GreyPicture> DecodeGrey(std::string_view bytes);

// DecodeGrey of a file; messages begin with the path.
[[nodiscard]] Result<GreyPicture> ReadGrey(const std::string& path);

// PNG, 8 or 16 bits, equal values give equal bytes (see EncodePng). Errors: an empty grid.
[[nodiscard]] Result<std::string> EncodeGreyPng(const Grid<std::uint8_t>& values);
[[nodiscard]] Result<std::string> EncodeGreyPng(const Grid<std::uint16_t>& values);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_GREY_PICTURE_H_
