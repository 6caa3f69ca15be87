#include "worker/segmentation/picture_size.h"

#include <string>

namespace depthfarm {

Status ValidatePictureSize(std::int64_t width, std::int64_t height) {
  if (width >= 1 && width <= kMaxPictureSide && height >= 1 && height <= kMaxPictureSide) return {};
  return InvalidArgument("picture is " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels, expected sides of 1 to " + std::to_string(kMaxPictureSide) +
                         "; larger pictures need --downscale");
}

}  // namespace depthfarm
