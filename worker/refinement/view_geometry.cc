#include "worker/refinement/view_geometry.h"

#include <cmath>
#include <cstddef>

#include "common/geometry/neighbours.h"

namespace depthfarm {
namespace {

constexpr int kMaxPairs = 4;

// M and e of T[.] in eq. (4) (Reprojection), e still per unit of 1/z.
PairGeometry PairOf(const Camera& source, const Camera& target, int other) {
  PairGeometry pair;
  pair.other = other;
  const Eigen::Matrix3d rotation =
      OrderedProduct(target.cam_from_world_rotation, Eigen::Matrix3d(source.cam_from_world_rotation.transpose()));
  const Eigen::Matrix3d m =
      OrderedProduct(OrderedProduct(target.intrinsics, rotation), InverseIntrinsics(source.intrinsics));
  const Eigen::Vector3d in_target =
      OrderedProduct(target.cam_from_world_rotation, CenterInWorld(source)) + target.cam_from_world_translation;
  const Eigen::Vector3d e = OrderedProduct(target.intrinsics, in_target);
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) pair.m[row][col] = m(row, col);
    pair.e[row] = e[row];
  }
  return pair;
}

// Pixels that the picture's centre moves in the other view per unit of 1/z, in the middle of the range.
double MotionPerInverseDepth(const Camera& camera, const PairGeometry& pair, double inverse_depth) {
  const double x = 0.5 * (camera.width - 1);
  const double y = 0.5 * (camera.height - 1);
  double q[3];
  for (int row = 0; row < 3; ++row)
    q[row] = pair.m[row][0] * x + pair.m[row][1] * y + pair.m[row][2] + pair.e[row] * inverse_depth;
  const double dx = (pair.e[0] - q[0] / q[2] * pair.e[2]) / q[2];
  const double dy = (pair.e[1] - q[1] / q[2] * pair.e[2]) / q[2];
  return std::sqrt(dx * dx + dy * dy);
}

}  // namespace

std::vector<ViewGeometry> RefinementGeometry(const ResolvedJob& job) {
  std::vector<Camera> cameras;
  for (const JobView& view : job.views) cameras.push_back(view.camera);
  const auto chosen = ChooseNeighbours(cameras, job.Levels(), kMaxPairs);
  std::vector<ViewGeometry> result(cameras.size());
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    const DepthRange& range = job.views[v].own_range;
    for (const int other : chosen[v])
      result[v].pairs.push_back(PairOf(cameras[v], cameras[static_cast<std::size_t>(other)], other));
    const double middle = 0.5 * (1 / range.z_near + 1 / range.z_far);
    double scale = 0;
    if (!result[v].pairs.empty()) scale = MotionPerInverseDepth(cameras[v], result[v].pairs.front(), middle);
    if (!(scale > 0) || !std::isfinite(scale)) scale = 1;
    result[v].pixels_per_inverse_depth = scale;
    result[v].u_near = scale / range.z_near;
    result[v].u_far = scale / range.z_far;
  }
  for (ViewGeometry& view : result) {
    for (PairGeometry& pair : view.pairs) {
      for (double& e : pair.e) e /= view.pixels_per_inverse_depth;
      pair.other_scale =
          result[static_cast<std::size_t>(pair.other)].pixels_per_inverse_depth / view.pixels_per_inverse_depth;
    }
  }
  return result;
}

SlantedPlane PlaneOfLevel(const ResolvedJob& job, int view, const ViewGeometry& geometry, Level level) {
  const DepthLevels levels = job.Levels();
  const LevelsInView in_view(job.views[static_cast<std::size_t>(view)].camera, levels);
  const double depth = levels.DepthInRef(level);
  const double s = geometry.pixels_per_inverse_depth;
  const double c = in_view.InverseDepth(0, 0, depth);
  return {s * (in_view.InverseDepth(1, 0, depth) - c), s * (in_view.InverseDepth(0, 1, depth) - c), s * c};
}

}  // namespace depthfarm
