#ifndef DEPTHFARM_COMMON_MEDIA_PICTURE_READER_H_
#define DEPTHFARM_COMMON_MEDIA_PICTURE_READER_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// The bytes of a picture file, for DecodePicture and for a digest of exactly what was decoded.
// Errors  those of ReadFileBytes; a raw picture has its exact size, an image file at most 1 GiB.
[[nodiscard]] Result<std::string> ReadPictureBytes(const std::string& path, const PictureFormat& format, int width,
                                                   int height);

// Decodes one picture of a camera of width x height pixels (before downscaling) to full-range BT.601 Y'CbCr in 8-bit
// units.
//
//   Image files: 8 or 16 bits (v / 257), grey (Cb = Cr = 128) or colour; alpha is ignored, EXIF rotation too
//   (calibration speaks of the raster as stored). Raw planes: see DecodeRawPicture. downscale 1, 2 or 4: box average
//   over downscale x downscale pixels, floor of the size, remaining columns and rows cut off; averaged at full
//   precision, so that there is one rounding (nearest, halves up).
// Deterministic: exact integer sums, then + - * / in double in a stated order (OpenCV's cvtColor and resize differ
// between CPUs). Decoded JPEG samples are those of the JPEG library in use. Errors  kInvalidArgument, without the path:
// damaged or cut short, not of width x height (both sizes are said), downscale
//         not 1, 2, 4 or larger than a side.
[[nodiscard]] Result<YcbcrImage> DecodePicture(std::string_view bytes, const PictureFormat& format, int width,
                                               int height, int downscale);

// Both; messages begin with the path.
[[nodiscard]] Result<YcbcrImage> ReadPicture(const std::string& path, const PictureFormat& format, int width,
                                             int height, int downscale);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_PICTURE_READER_H_
