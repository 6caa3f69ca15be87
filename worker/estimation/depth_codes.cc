#include <algorithm>
#include <cmath>
#include <cstddef>

#include "worker/estimation/estimation.h"

namespace depthfarm {

Grid<std::uint16_t> DepthCodes(const ResolvedJob& job, int view_index, const Grid<SegmentIndex>& segment_labels,
                               const ViewLabels& labels) {
  const JobView& view = job.views[static_cast<std::size_t>(view_index)];
  const DepthLevels levels = job.Levels();
  const LevelsInView in_view(view.camera, levels);
  std::vector<double> depth_in_ref;
  for (int level = 0; level < levels.count(); ++level) depth_in_ref.push_back(levels.DepthInRef(level));

  constexpr double kSteps = 65534;
  const double far_inverse = 1.0 / view.own_range.z_far;
  const double scale = kSteps / (1.0 / view.own_range.z_near - far_inverse);
  Grid<std::uint16_t> codes(segment_labels.width(), segment_labels.height());
  for (int y = 0; y < codes.height(); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      const double inverse = in_view.InverseDepth(x, y, depth_in_ref[labels.levels[segment_labels(x, y)]]);
      if (!(inverse > 0) || !std::isfinite(inverse)) continue;
      const double code = std::floor((inverse - far_inverse) * scale + 0.5);
      codes(x, y) = static_cast<std::uint16_t>(1 + std::clamp(code, 0.0, kSteps));
    }
  }
  return codes;
}

}  // namespace depthfarm
