#include "common/geometry/neighbours.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "common/geometry/reprojection.h"

namespace depthfarm {
namespace {

constexpr double kMinOverlap = 0.25;
constexpr double kMinAxisCosine = 0.5;  // 60 degrees
constexpr int kGrid = 8;                // samples a side for the overlap

double MiddleDepthInRef(const DepthLevels& levels) { return 2.0 / (1.0 / levels.z_near() + 1.0 / levels.z_far()); }

double Length(const Eigen::Vector3d& v) { return std::sqrt(OrderedDot(v, v)); }

double Overlap(const Camera& view, const Camera& other, const DepthLevels& levels) {
  const LevelsInView in_view(view, levels);
  const Reprojection other_from_view(view, other);
  const double depth = MiddleDepthInRef(levels);
  int seen = 0;
  for (int row = 0; row < kGrid; ++row) {
    for (int col = 0; col < kGrid; ++col) {
      const double x = (col + 0.5) * view.width / kGrid - 0.5;
      const double y = (row + 0.5) * view.height / kGrid - 0.5;
      const double inverse = in_view.InverseDepth(x, y, depth);
      if (!(inverse > 0)) continue;
      const Reprojection::Projected p = other_from_view.Project(x, y, inverse);
      if (p.depth_per_source <= 0) continue;
      if (p.x >= -0.5 && p.y >= -0.5 && p.x <= other.width - 0.5 && p.y <= other.height - 0.5) ++seen;
    }
  }
  return static_cast<double>(seen) / (kGrid * kGrid);
}

struct Candidate {
  int index = 0;
  double distance = 0;
  Eigen::Vector3d direction;
};

std::vector<Candidate> Candidates(const std::vector<Camera>& views, int view_index, const DepthLevels& levels) {
  const Camera& view = views[static_cast<std::size_t>(view_index)];
  const Eigen::Vector3d center = CenterInWorld(view);
  const Eigen::Vector3d x_axis = view.cam_from_world_rotation.row(0).transpose();
  std::vector<Candidate> result;
  for (int other_index = 0; other_index < static_cast<int>(views.size()); ++other_index) {
    if (other_index == view_index) continue;
    const Camera& other = views[static_cast<std::size_t>(other_index)];
    const Eigen::Vector3d baseline = CenterInWorld(other) - center;
    const double length = Length(baseline);
    if (!(length > 0)) continue;  // the same place: no parallax, no evidence
    if (OrderedDot(OpticalAxisInWorld(view), OpticalAxisInWorld(other)) < kMinAxisCosine) continue;
    if (Overlap(view, other, levels) < kMinOverlap) continue;
    const Eigen::Vector3d direction = baseline / length;
    const double along = std::abs(OrderedDot(direction, x_axis));
    result.push_back({other_index, length * (1.0 - 0.05 * along), direction});
  }
  if (result.empty()) return result;
  // In millionths of the nearest, so that equal steps of a grid stay equal whatever the world frame and unit.
  double nearest = result.front().distance;
  for (const Candidate& candidate : result) nearest = std::min(nearest, candidate.distance);
  const auto key = [&](const Candidate& candidate) {
    return std::pair<double, const std::string&>(std::round(candidate.distance / nearest * 1e6),
                                                 views[static_cast<std::size_t>(candidate.index)].name);
  };
  std::sort(result.begin(), result.end(), [&](const Candidate& a, const Candidate& b) { return key(a) < key(b); });
  return result;
}

}  // namespace

std::vector<std::vector<int>> ChooseNeighbours(const std::vector<Camera>& views, const DepthLevels& levels,
                                               int max_neighbours) {
  std::vector<double> passes = {-0.5, 0.5};  // largest cosine allowed between two chosen baselines
  if (max_neighbours > 2) passes.push_back(2.0);
  std::vector<std::vector<int>> result(views.size());
  for (int view_index = 0; view_index < static_cast<int>(views.size()); ++view_index) {
    const std::vector<Candidate> candidates = Candidates(views, view_index, levels);
    std::vector<const Candidate*> chosen;
    for (const double largest_cosine : passes) {
      for (const Candidate& candidate : candidates) {
        if (static_cast<int>(chosen.size()) >= max_neighbours) break;
        const bool apart = std::all_of(chosen.begin(), chosen.end(), [&](const Candidate* other) {
          return other != &candidate && OrderedDot(other->direction, candidate.direction) < largest_cosine;
        });
        if (apart) chosen.push_back(&candidate);
      }
    }
    std::sort(chosen.begin(), chosen.end());  // candidates are in order of distance: pointer order is that order
    for (const Candidate* candidate : chosen) result[static_cast<std::size_t>(view_index)].push_back(candidate->index);
  }
  return result;
}

int CentreCamera(const std::vector<Camera>& views) {
  int best = 0;
  double best_sum = 0;
  for (int i = 0; i < static_cast<int>(views.size()); ++i) {
    const Camera& view = views[static_cast<std::size_t>(i)];
    std::vector<double> distances;  // added in ascending order: the order of the file must not change the sum
    for (const Camera& other : views) distances.push_back(Length(CenterInWorld(other) - CenterInWorld(view)));
    std::sort(distances.begin(), distances.end());
    double sum = 0;
    for (const double distance : distances) sum += distance;
    const double tolerance = 1e-6 * std::max(sum, best_sum);
    const bool better = i == 0 || sum < best_sum - tolerance ||
                        (sum < best_sum + tolerance && view.name < views[static_cast<std::size_t>(best)].name);
    if (better) {
      best = i;
      best_sum = sum;
    }
  }
  return best;
}

double DisparityRange(const Camera& view, const Camera& neighbour, const DepthLevels& levels) {
  const LevelsInView in_view(view, levels);
  const Reprojection neighbour_from_view(view, neighbour);
  const double x = (view.width - 1) / 2.0;
  const double y = (view.height - 1) / 2.0;
  Eigen::Vector2d ends[2];
  int end = 0;
  for (const double depth : {levels.z_far(), levels.z_near()}) {
    const double inverse = in_view.InverseDepth(x, y, depth);
    if (!(inverse > 0)) return 0;
    const Reprojection::Projected p = neighbour_from_view.Project(x, y, inverse);
    if (p.depth_per_source <= 0) return 0;
    ends[end++] = Eigen::Vector2d(p.x, p.y);
  }
  const double dx = ends[1][0] - ends[0][0];
  const double dy = ends[1][1] - ends[0][1];
  return std::sqrt(dx * dx + dy * dy);
}

}  // namespace depthfarm
