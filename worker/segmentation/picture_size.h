#ifndef DEPTHFARM_WORKER_SEGMENTATION_PICTURE_SIZE_H_
#define DEPTHFARM_WORKER_SEGMENTATION_PICTURE_SIZE_H_

#include <cstdint>

#include "common/base/status.h"

namespace depthfarm {

// Largest width and height that are segmented. The exact integer arithmetic of this folder rests on it: sums of n times
// a squared position stay below 2^60 (DescribeSegments), pushes of SNIC below 2^32, a coordinate fits 16 bits.
inline constexpr int kMaxPictureSide = 16384;

// kInvalidArgument unless both sides are in 1..kMaxPictureSide.
[[nodiscard]] Status ValidatePictureSize(std::int64_t width, std::int64_t height);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_PICTURE_SIZE_H_
