#ifndef DEPTHFARM_COMMON_MEDIA_GUIDE_FILES_H_
#define DEPTHFARM_COMMON_MEDIA_GUIDE_FILES_H_

#include <cstdint>
#include <string_view>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/image/picture.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// Maps of any resolution with about the picture's proportions are sampled at the nearest of their pixels; errors
// (kInvalidArgument, without the path): not decodable, other proportions (the sides differ by more than 2 %), a format
// that does not fit the file.

// Prior depth as inverse depth, W x H: 1/z, or of kRelativeDepth the values of the file; 0 where it is not known (not
// finite, not > 0, code 0). `bytes`: PFM, OpenEXR or a grey picture; kCodes: a grey
// picture of 16 bits, or a raw one of W x H (DepthFormat).
[[nodiscard]] Result<Grid<float>> DecodePrior(std::string_view bytes, const PriorFormat& format, int width, int height);

// A grey picture, 0..1 of its full range: confidence.
[[nodiscard]] Result<Grid<float>> DecodeShare(std::string_view bytes, int width, int height);

// Sets Ycbcr::matte of a picture from a mask: 0 to kForegroundMatte.
[[nodiscard]] Status ApplyMask(std::string_view bytes, YcbcrImage& picture);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_GUIDE_FILES_H_
