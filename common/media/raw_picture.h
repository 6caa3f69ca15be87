#ifndef DEPTHFARM_COMMON_MEDIA_RAW_PICTURE_H_
#define DEPTHFARM_COMMON_MEDIA_RAW_PICTURE_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "common/sequence/picture_format.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// Raw planar picture -> Y'CbCr, 1/downscale of the size (see DecodePicture for the contract of sizes and rounding).
//
//   Chroma of 4:2:0 lies as in MPEG-2 and H.264 by default: on the even columns, half-way between the rows; that of
//   4:2:2 on the even columns. It is brought to full resolution linearly, weights 1 and 1/2, 1/2 across, 3/4, 1/4 down,
//   edges repeated, in exact integers. Then, at full precision, box average, range and matrix:
//     limited  Y' = 255 (v - 16) / 219, C = 255 (v - 128) / 224 with v in 8-bit units (sample / 2^(bits - 8))
//     full     Y' = 255 v / (2^bits - 1), C = 255 (v - 2^(bits - 1)) / (2^bits - 1)
//   4:0:0 gives Cb = Cr = 128.
// Errors (kInvalidArgument, without the path): another number of bytes (both are said), a sample beyond `bits`.
[[nodiscard]] Result<YcbcrImage> DecodeRawPicture(std::string_view bytes, const PictureFormat& format, int width,
                                                  int height, int downscale);

// The inverse: planar full-range BT.601 4:2:0 without a header, `bits` 8..16 (two bytes little-endian beyond 8). A
// chroma sample is the mean of what lies around its place, which is the one that decoding assumes: weights 1/4, 1/2,
// 1/4 across, 1/2, 1/2 down, edges repeated.
[[nodiscard]] std::string EncodeRawYuv420(const RgbImage& picture, int bits);

// The same of a picture in Y'CbCr, 8 bits, limited range (16-235): what players and encoders take YUV for.
[[nodiscard]] std::string EncodeLimitedYuv420(const YcbcrImage& picture);

// Y samples of 16 bits as stored, in 4:2:0 with grey chroma: how depth maps are kept as video.
[[nodiscard]] std::string EncodeRawLuma16(const Grid<std::uint16_t>& luma);

// The Y samples alone, as stored, e.g. of depth maps kept as video.
[[nodiscard]] Result<Grid<std::uint16_t>> DecodeRawLuma(std::string_view bytes, const PictureFormat& format, int width,
                                                        int height);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_RAW_PICTURE_H_
