#include "worker/refinement/view_geometry.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "common/geometry/reprojection.h"

namespace depthfarm {
namespace {

constexpr double kLeastMotion = 1e-3;  // pixels over the view's depth range: less is rounding, not parallax

// Pixels that a pixel moves in the other view per unit of 1/z; nullopt: it is behind that view.
std::optional<double> MotionPerInverseDepth(const Reprojection& pair, double x, double y, double inverse_depth) {
  const Reprojection::Projected there = pair.Project(x, y, inverse_depth);
  if (!(there.depth_per_source > 0)) return std::nullopt;
  const double dx = (pair.e()[0] - there.x * pair.e()[2]) / there.depth_per_source;
  const double dy = (pair.e()[1] - there.y * pair.e()[2]) / there.depth_per_source;
  return std::sqrt(dx * dx + dy * dy);  // not std::hypot, whose last bits differ between machines
}

// Mean over the picture's centre and corners: where cameras stand one behind the other, the centre does not move at
// all.
double MeanMotion(const Camera& camera, const Camera& other, double inverse_depth) {
  const Reprojection pair(camera, other);
  const double right = camera.width - 1;
  const double bottom = camera.height - 1;
  const std::array<std::array<double, 2>, 5> pixels{
      {{right / 2, bottom / 2}, {0, 0}, {right, 0}, {0, bottom}, {right, bottom}}};
  double sum = 0;
  int count = 0;
  for (const auto& [x, y] : pixels) {
    const auto motion = MotionPerInverseDepth(pair, x, y, inverse_depth);
    if (!motion || !std::isfinite(*motion)) continue;
    sum += *motion;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

double PixelsPerInverseDepth(const ResolvedJob& job, const JobView& view) {
  const double middle = 0.5 * (1 / view.own_range.z_near + 1 / view.own_range.z_far);
  const double extent = 1 / view.own_range.z_near - 1 / view.own_range.z_far;
  for (const int other : view.compared) {
    const double scale = MeanMotion(view.camera, job.views[static_cast<std::size_t>(other)].camera, middle);
    if (scale * extent >= kLeastMotion) return scale;
  }
  return 1 / extent;  // no view tells depths apart: the whole range is one pixel, whatever the unit of length
}

}  // namespace

ViewGeometry RefinementGeometry(const ResolvedJob& job, int view) {
  const JobView& own = job.views[static_cast<std::size_t>(view)];
  ViewGeometry result{.pixels_per_inverse_depth = PixelsPerInverseDepth(job, own), .pairs = {}};
  const double scale = result.pixels_per_inverse_depth;
  for (const int other : own.compared) {
    const JobView& there = job.views[static_cast<std::size_t>(other)];
    const Reprojection pair(own.camera, there.camera);
    result.pairs.push_back({.other = other,
                            .m = pair.m(),
                            .e = pair.e() / scale,
                            .other_scale = PixelsPerInverseDepth(job, there) / scale});
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
