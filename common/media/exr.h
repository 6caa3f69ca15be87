#ifndef DEPTHFARM_COMMON_MEDIA_EXR_H_
#define DEPTHFARM_COMMON_MEDIA_EXR_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/grid.h"

namespace depthfarm {

// Whether bytes begin as an OpenEXR file does.
[[nodiscard]] bool IsExr(std::string_view bytes);

// One channel of an OpenEXR file, as 32-bit floats: Z, or the only one that there is. Values are kept as they are, NaN
// and infinities included. Errors (kInvalidArgument, without the path): not decodable, deep or of several parts,
// several channels and none is Z, pixels outside of the picture, sides beyond 32768, more pixels than a file of that
// size holds.
[[nodiscard]] Result<Grid<float>> DecodeExr(std::string_view bytes);

// Channel Z, compressed without loss (PIZ). Equal grids give equal bytes with equal versions of OpenEXR. Errors: an
// empty grid.
[[nodiscard]] Result<std::string> EncodeExr(const Grid<float>& values);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_EXR_H_
