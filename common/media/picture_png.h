#ifndef DEPTHFARM_COMMON_MEDIA_PICTURE_PNG_H_
#define DEPTHFARM_COMMON_MEDIA_PICTURE_PNG_H_

#include <cstddef>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// A picture in somebody's memory: rows from top to bottom.
struct PictureSamples {
  int width = 0;
  int height = 0;
  int channels = 3;          // 1: grey; 3: red, green, blue
  int bytes_per_sample = 1;  // 1: 0 to 255; 2: 0 to 65535, in the machine's byte order
  const void* data = nullptr;
  std::size_t row_bytes = 0;  // from one row to the next; 0: rows follow each other
};

// A PNG of the same samples. kInvalidArgument: no such picture: empty, other channels or sample sizes, rows that
// overlap.
[[nodiscard]] Result<std::string> EncodePicturePng(const PictureSamples& picture);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_PICTURE_PNG_H_
