#include "worker/refinement/view_geometry.h"

#include <cmath>
#include <cstddef>

#include "common/geometry/reprojection.h"

namespace depthfarm {
namespace {

// Pixels that the picture's centre moves in the other view per unit of 1/z, in the middle of the range.
double MotionPerInverseDepth(const Camera& camera, const Reprojection& pair, double inverse_depth) {
  const double x = 0.5 * (camera.width - 1);
  const double y = 0.5 * (camera.height - 1);
  const Reprojection::Projected there = pair.Project(x, y, inverse_depth);
  const double dx = (pair.e()[0] - there.x * pair.e()[2]) / there.depth_per_source;
  const double dy = (pair.e()[1] - there.y * pair.e()[2]) / there.depth_per_source;
  return std::sqrt(dx * dx + dy * dy);  // not std::hypot, whose last bits differ between machines
}

double PixelsPerInverseDepth(const ResolvedJob& job, const JobView& view) {
  if (view.compared.empty()) return 1;
  const Camera& nearest = job.views[static_cast<std::size_t>(view.compared.front())].camera;
  const double middle = 0.5 * (1 / view.own_range.z_near + 1 / view.own_range.z_far);
  const double scale = MotionPerInverseDepth(view.camera, Reprojection(view.camera, nearest), middle);
  return scale > 0 && std::isfinite(scale) ? scale : 1;
}

}  // namespace

std::vector<ViewGeometry> RefinementGeometry(const ResolvedJob& job) {
  std::vector<ViewGeometry> result(job.views.size());
  for (std::size_t v = 0; v < result.size(); ++v)
    result[v].pixels_per_inverse_depth = PixelsPerInverseDepth(job, job.views[v]);
  for (std::size_t v = 0; v < result.size(); ++v) {
    const double scale = result[v].pixels_per_inverse_depth;
    for (const int other : job.views[v].compared) {
      const auto o = static_cast<std::size_t>(other);
      const Reprojection pair(job.views[v].camera, job.views[o].camera);
      result[v].pairs.push_back({.other = other,
                                 .m = pair.m(),
                                 .e = pair.e() / scale,
                                 .other_scale = result[o].pixels_per_inverse_depth / scale});
    }
  }
  return result;
}

std::vector<SlantedPlane> PlanesOfLevels(const ResolvedJob& job, int view, const ViewGeometry& geometry) {
  const DepthLevels levels = job.Levels();
  const LevelsInView in_view(job.views[static_cast<std::size_t>(view)].camera, levels);
  const double s = geometry.pixels_per_inverse_depth;
  std::vector<SlantedPlane> planes;
  planes.reserve(static_cast<std::size_t>(levels.count()));
  for (int level = 0; level < levels.count(); ++level) {
    const double depth = levels.DepthInRef(level);
    const double c = in_view.InverseDepth(0, 0, depth);
    planes.push_back({static_cast<float>(s * (in_view.InverseDepth(1, 0, depth) - c)),
                      static_cast<float>(s * (in_view.InverseDepth(0, 1, depth) - c)), static_cast<float>(s * c)});
  }
  return planes;
}

}  // namespace depthfarm
