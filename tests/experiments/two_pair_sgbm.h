#ifndef DEPTHFARM_TESTS_EXPERIMENTS_TWO_PAIR_SGBM_H_
#define DEPTHFARM_TESTS_EXPERIMENTS_TWO_PAIR_SGBM_H_

#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"
#include "common/image/picture.h"

namespace depthfarm {

// A view and its picture. Borrowed.
struct StereoView {
  const YcbcrImage* picture = nullptr;
  Camera camera;
};

// The depth that people make today: OpenCV's StereoSGBM (MODE_HH, colour, block 5) of the view with each of its
// neighbours, rectified; where two depths are known, their mean if they agree within 2 %, else the farther; holes take
// the farther of the nearest depths in their row, empty rows those of the nearest row. Own z of `view`, no holes unless
// a whole picture is one. A neighbour that cannot be rectified is left out; kInvalidArgument where none can. At
// most 512 disparities from the farthest on are searched.
[[nodiscard]] Result<DepthMap> EstimateBySgbm(const StereoView& view, const std::vector<StereoView>& neighbours,
                                              const DepthRange& range);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_EXPERIMENTS_TWO_PAIR_SGBM_H_
