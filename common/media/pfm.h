#ifndef DEPTHFARM_COMMON_MEDIA_PFM_H_
#define DEPTHFARM_COMMON_MEDIA_PFM_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/grid.h"

namespace depthfarm {

// Portable float map, one channel ("Pf"): a header of three lines, then rows of 32-bit floats, the bottom row first; a
// negative scale says little-endian, a positive one big-endian (its magnitude is not applied). The Grid has the top row
// first. Values are kept as they are, NaN and infinities included.
// Errors (kInvalidArgument, without the path): another header, colour, sides beyond 32768, another number of bytes.
[[nodiscard]] Result<Grid<float>> DecodePfm(std::string_view bytes);

// Little-endian PFM; equal grids give equal bytes.
[[nodiscard]] std::string EncodePfm(const Grid<float>& values);

// DecodePfm of a file; messages begin with the path.
[[nodiscard]] Result<Grid<float>> ReadPfm(const std::string& path);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_PFM_H_
