#ifndef DEPTHFARM_WORKER_SEGMENTATION_MASK_TRUST_H_
#define DEPTHFARM_WORKER_SEGMENTATION_MASK_TRUST_H_

#include "common/image/picture.h"

namespace depthfarm {

// How much higher the picture's steps of colour are along the contours of its mask (Ycbcr::matte) than three and four
// pixels to either side: 3 to 5 for a mask that follows what it is of, about 1 for one that is shifted or grown by
// several pixels. 0 for a mask without contours.
[[nodiscard]] double ContrastAlongMask(const YcbcrImage& picture);

// Leaves the mask as it is where its contours follow the picture's (contrast 2), weakens it below, drops it at 1.3: its
// edges would be taken for depth edges. Returns how much of it is left, 0 to 1; 1 also for a mask without contours, of
// which nothing can be.
double WeighMask(YcbcrImage& picture);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_MASK_TRUST_H_
