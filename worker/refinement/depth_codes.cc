#include <algorithm>
#include <cmath>
#include <cstddef>

#include "worker/refinement/refine.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {
namespace {

// Pixels of u. A plane so little behind infinity cannot be told from one at infinity: it has the farthest depth.
constexpr double kBehindInfinity = 1;

}  // namespace

Grid<std::uint16_t> RefinedDepthCodes(const ResolvedJob& job, int view, const RefinedView& refined) {
  const auto v = static_cast<std::size_t>(view);
  const double pixels = RefinementGeometry(job, view).pixels_per_inverse_depth;
  const DepthRange& range = job.views[v].own_range;
  constexpr double kSteps = 65534;
  const double far_inverse = 1.0 / range.z_far;
  const double scale = kSteps / (1.0 / range.z_near - far_inverse);
  Grid<std::uint16_t> codes(refined.plane_of_pixel.width(), refined.plane_of_pixel.height());
  for (int y = 0; y < codes.height(); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      const double u = refined.At(x, y);
      if (!(u > -kBehindInfinity) || !std::isfinite(u)) continue;
      const double code = std::clamp((u / pixels - far_inverse) * scale + 0.5, 0.0, kSteps);
      codes(x, y) = static_cast<std::uint16_t>(1 + static_cast<int>(code));  // cut off: the floor
    }
  }
  return codes;
}

}  // namespace depthfarm
