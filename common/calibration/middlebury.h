#ifndef DEPTHFARM_COMMON_CALIBRATION_MIDDLEBURY_H_
#define DEPTHFARM_COMMON_CALIBRATION_MIDDLEBURY_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// *_par.txt of the Middlebury multi-view sets (S. Seitz et al., CVPR 2006): the number of cameras, then of each one
// line: the name of its picture, 9 numbers of K, 9 of R, 3 of t, x_cam = R X + t, pixels as everywhere here. A camera
// is called as its picture without the ending. `size` is that of all pictures; `file` is for messages.
// Errors  kInvalidArgument naming file, line and camera: words too few, too many or no numbers, another number of
//         cameras than said, one that is there twice, K or R that are none.
[[nodiscard]] Result<Calibration> ParseMiddleburyCameras(std::string_view text, const std::string& file,
                                                         const PictureSize& size);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_MIDDLEBURY_H_
