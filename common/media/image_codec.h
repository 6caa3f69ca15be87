#ifndef DEPTHFARM_COMMON_MEDIA_IMAGE_CODEC_H_
#define DEPTHFARM_COMMON_MEDIA_IMAGE_CODEC_H_

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// The only call of OpenCV's codecs, with its exceptions turned into Status. Used within common/media only: the other
// headers of the folder do not show OpenCV.

// Decodes an image file held in memory as stored: no rotation by EXIF, no change of depth; palettes are expanded.
// Result: 8- or 16-bit unsigned, 1 (grey), 3 (B, G, R) or 4 (B, G, R, alpha) channels.
// Kinds, told by how the bytes begin: PNG, JPEG, TIFF, BMP, PBM, PGM, PPM, WebP, JPEG 2000. No other one gets to
// OpenCV, which would write it to a temporary file. Errors (kInvalidArgument, without the path): empty, of another
// kind, not decodable, a JPEG that ends early (OpenCV would leave its lower rows as they are), more pixels than so few
// bytes can hold (64 MiB and 9,000 decoded bytes for each), other sample types. kUnavailable: no memory.
[[nodiscard]] Result<cv::Mat> DecodeImage(std::string_view bytes);

// Whether a JPEG's marker segments and scans run up to its end-of-image marker.
[[nodiscard]] bool IsCompleteJpeg(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_IMAGE_CODEC_H_
