#include "tests/experiments/pixel_cut.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>

#include "common/geometry/reprojection.h"
#include "common/synthesis/sample_surface.h"

namespace depthfarm {
namespace {

constexpr double kCostsPerGrey = 64;  // 765 grey levels fit 16 bits
constexpr double kPaperSteps = 249;   // as SmoothnessCost counts |d_s - d_t|
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

// Mean over those of the pixels around that are seen; kOutside where the middle one is not.
float WindowMean(const Grid<float>& difference, int x, int y, int radius) {
  if (difference(x, y) == kOutside) return kOutside;
  float sum = 0;
  int count = 0;
  for (int v = std::max(0, y - radius); v <= std::min(difference.height() - 1, y + radius); ++v) {
    for (int u = std::max(0, x - radius); u <= std::min(difference.width() - 1, x + radius); ++u) {
      if (difference(u, v) == kOutside) continue;
      sum += difference(u, v);
      ++count;
    }
  }
  return sum / static_cast<float>(count);
}

template <typename T>
Status OutOfRange(const std::string& option, T value, const std::string& expected) {
  std::ostringstream text;
  text << option << " is " << value << ", expected " << expected;
  return InvalidArgument(text.str());
}

}  // namespace

Status PixelCutParams::Validate() const {
  if (window < 1 || window > 15 || window % 2 == 0) return OutOfRange("window", window, "an odd number from 1 to 15");
  if (!(most_difference > 0) || most_difference > 765)
    return OutOfRange("most-difference", most_difference, "> 0, at most 765");
  if (!(smoothing >= 0) || smoothing > 100) return OutOfRange("smoothing", smoothing, "0 to 100");
  if (!(most_jump >= 1) || most_jump > kPaperSteps) return OutOfRange("most-jump", most_jump, "1 to 249");
  if (sweeps < 0) return OutOfRange("sweeps", sweeps, ">= 0");
  return {};
}

PixelLabelling PixelCutProblem(const StereoView& view, const std::vector<StereoView>& neighbours,
                               const DepthLevels& levels, const PixelCutParams& params) {
  PixelLabelling problem(view.camera.width, view.camera.height, levels.count());
  const double per_step = kPaperSteps / (levels.count() - 1);
  problem.step = static_cast<std::int32_t>(std::lround(params.smoothing * per_step * kCostsPerGrey));
  problem.most_steps = std::max(1, static_cast<int>(std::lround(params.most_jump / per_step)));
  for (int level = 0; level < levels.count(); ++level) {
    std::uint16_t* costs = problem.CostsOf(level);
    std::fill_n(costs, problem.num_pixels(), static_cast<std::uint16_t>(params.most_difference * kCostsPerGrey));
    for (const StereoView& neighbour : neighbours) {
      const Grid<float> difference = DifferenceOnLevel(view, neighbour, levels, level);
      std::uint16_t* cost = costs;
      for (int y = 0; y < problem.height; ++y) {
        for (int x = 0; x < problem.width; ++x, ++cost) {
          const float mean = WindowMean(difference, x, y, params.window / 2);
          if (mean != kOutside) *cost = static_cast<std::uint16_t>(std::min<double>(*cost, mean * kCostsPerGrey));
        }
      }
    }
  }
  return problem;
}

Result<DepthMap> EstimateByPixelCut(const StereoView& view, const std::vector<StereoView>& neighbours,
                                    const DepthLevels& levels, const PixelCutParams& params) {
  if (neighbours.empty()) return InvalidArgument("camera '" + view.camera.name + "' has no neighbour");
  DEPTHFARM_RETURN_IF_ERROR(params.Validate());
  const PixelLabelling problem = PixelCutProblem(view, neighbours, levels, params);
  std::vector<Level> labels = CheapestLevels(problem);
  (void)ExpandPixels(problem, params.sweeps, labels);
  const LevelsInView in_view(view.camera, levels);
  DepthMap depth(problem.width, problem.height);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const double inverse = in_view.InverseDepth(x, y, levels.DepthInRef(labels[depth.Index(x, y)]));
      depth(x, y) = inverse > 0 ? static_cast<float>(1 / inverse) : 0.0F;
    }
  }
  return depth;
}

}  // namespace depthfarm
