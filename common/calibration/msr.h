#ifndef DEPTHFARM_COMMON_CALIBRATION_MSR_H_
#define DEPTHFARM_COMMON_CALIBRATION_MSR_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// calibParams of the sequences Ballet and Breakdancers (C. L. Zitnick et al., SIGGRAPH 2004): of each camera its
// number, three rows of K, two zeros, three rows of [R | t], x_cam = R X + t with z forward, y UP, and rows counted
// from the BOTTOM row of a picture. With F = diag(1, -1, 1) and pictures of h rows the result is R' = F R F, t' = F t,
// cy' = h - 1 - cy and the skew negated; the y of the world is turned round with it. Camera n is called "camN".
// `size` is that of all pictures; `file` is for messages.
// Errors  those of ParseFtvCameras.
[[nodiscard]] Result<Calibration> ParseMsrCameras(std::string_view text, const std::string& file,
                                                  const PictureSize& size);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_MSR_H_
