#ifndef DEPTHFARM_COMMON_MEDIA_PNG_ENCODER_H_
#define DEPTHFARM_COMMON_MEDIA_PNG_ENCODER_H_

#include <opencv2/core/mat.hpp>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// PNG of an 8- or 16-bit image with 1 or 3 (B, G, R) channels, no time stamp and no text: equal images give equal bytes
// with equal versions of libdeflate. One pass of a filter that suits what is kept in so many bits, pictures or depth,
// then libdeflate: 0.4 times the time of libpng with zlib, whose files are as large. Used within common/media only.
// Errors: kInvalidArgument: no pixels, or of another kind; kUnavailable: no memory.
[[nodiscard]] Result<std::string> EncodePng(const cv::Mat& image);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_PNG_ENCODER_H_
