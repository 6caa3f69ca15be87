#include "tests/experiments/pixel_cut.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/geometry/reprojection.h"
#include "common/synthesis/sample_surface.h"
#include "tests/experiments/anchored_problem.h"

namespace depthfarm {
namespace {

constexpr float kOutside = -1;

// Grey levels of difference on one level, pixel by pixel; kOutside where the neighbour does not see the point.
Grid<float> DifferenceOnLevel(const StereoView& view, const StereoView& neighbour, const DepthLevels& levels,
                              int level) {
  const LevelsInView in_view(view.camera, levels);
  const Reprojection neighbour_from_view(view.camera, neighbour.camera);
  const double depth_in_ref = levels.DepthInRef(level);
  Grid<float> difference(view.camera.width, view.camera.height, kOutside);
  for (int y = 0; y < difference.height(); ++y) {
    for (int x = 0; x < difference.width(); ++x) {
      const double inverse = in_view.InverseDepth(x, y, depth_in_ref);
      if (!(inverse > 0)) continue;
      const Reprojection::Projected p = neighbour_from_view.Project(x, y, inverse);
      if (!(p.depth_per_source > 0 && p.x >= 0 && p.y >= 0 && p.x <= neighbour.camera.width - 1 &&
            p.y <= neighbour.camera.height - 1)) {
        continue;
      }
      const Colour there = SampleBilinear(*neighbour.picture, p.x, p.y);
      const Ycbcr& here = (*view.picture)(x, y);
      difference(x, y) = std::abs(there[0] - static_cast<float>(here.y)) +
                         std::abs(there[1] - static_cast<float>(here.cb)) +
                         std::abs(there[2] - static_cast<float>(here.cr));
    }
  }
  return difference;
}

// Mean over those of the 3 x 3 pixels around that are seen; kOutside where the middle one is not.
float WindowMean(const Grid<float>& difference, int x, int y) {
  if (difference(x, y) == kOutside) return kOutside;
  float sum = 0;
  int count = 0;
  for (int v = std::max(0, y - 1); v <= std::min(difference.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(difference.width() - 1, x + 1); ++u) {
      if (difference(u, v) == kOutside) continue;
      sum += difference(u, v);
      ++count;
    }
  }
  return sum / static_cast<float>(count);
}

}  // namespace

Result<DepthMap> EstimateByPixelCut(const StereoView& view, const std::vector<StereoView>& neighbours,
                                    const DepthLevels& levels, const PixelCutParams& params) {
  if (neighbours.empty()) return InvalidArgument("camera '" + view.camera.name + "' has no neighbour");
  const int width = view.camera.width;
  const int height = view.camera.height;
  const auto node = [width](int x, int y) { return static_cast<NodeIndex>(y * width + x); };
  AnchoredProblem problem(static_cast<NodeIndex>(width * height), levels.count());
  for (int level = 0; level < levels.count(); ++level) {
    std::vector<Grid<float>> differences;
    for (const StereoView& neighbour : neighbours) {
      differences.push_back(DifferenceOnLevel(view, neighbour, levels, level));
    }
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double least = params.most_difference;
        for (const Grid<float>& difference : differences) {
          const float mean = WindowMean(difference, x, y);
          if (mean != kOutside) least = std::min(least, static_cast<double>(mean));
        }
        const double reward = (params.most_difference - least) * kMatchStepsPerGrey;
        problem.SetReward(level, node(x, y), static_cast<std::uint16_t>(std::lround(reward)));
      }
    }
  }
  // Even, as the core wants its coefficients.
  const double units = params.smoothing * kEnergyUnitsPerGrey * 249 / (levels.count() - 1);
  const auto beta = static_cast<std::int32_t>(2 * std::lround(units / 2));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) problem.smoothness().push_back({node(x, y), node(x + 1, y), beta});
      if (y + 1 < height) problem.smoothness().push_back({node(x, y), node(x, y + 1), beta});
    }
  }
  const std::vector<Level> labels = problem.Solve(params.sweeps);
  const LevelsInView in_view(view.camera, levels);
  DepthMap depth(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double inverse = in_view.InverseDepth(x, y, levels.DepthInRef(labels[node(x, y)]));
      depth(x, y) = inverse > 0 ? static_cast<float>(1 / inverse) : 0.0F;
    }
  }
  return depth;
}

}  // namespace depthfarm
