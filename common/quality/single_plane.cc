#include "common/quality/single_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/geometry/reprojection.h"
#include "common/synthesis/sample_surface.h"
#include "common/synthesis/synthesize_view.h"

namespace depthfarm {
namespace {

struct PlaneSource {
  const YcbcrImage* picture = nullptr;
  Reprojection source_from_target;
  float weight = 0;
};

std::vector<PlaneSource> Prepare(const std::vector<PictureView>& sources, const Camera& target) {
  std::vector<Camera> cameras;
  cameras.reserve(sources.size());
  for (const PictureView& source : sources) cameras.push_back(source.camera);
  const std::vector<double> weights = NearnessWeights(cameras, target);
  std::vector<PlaneSource> result;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    result.push_back({sources[i].picture, Reprojection(target, sources[i].camera), static_cast<float>(weights[i])});
  }
  return result;
}

// Y, Cb, Cr that the sources show at pixel (x, y) of the target if its point has 1/z = inverse_depth.
std::array<float, 3> ColourAt(const std::vector<PlaneSource>& sources, int x, int y, double inverse_depth) {
  std::array<float, 3> inside = {};
  std::array<float, 3> outside = {};
  float inside_weight = 0;
  float outside_weight = 0;
  for (const PlaneSource& source : sources) {
    const Reprojection::Projected p = source.source_from_target.Project(x, y, inverse_depth);
    if (!(p.depth_per_source > 0)) continue;
    const Colour colour = SampleBilinear(*source.picture, p.x, p.y);
    const bool in =
        p.x >= -0.5 && p.y >= -0.5 && p.x <= source.picture->width() - 0.5 && p.y <= source.picture->height() - 0.5;
    for (std::size_t c = 0; c < 3; ++c) (in ? inside : outside)[c] += source.weight * colour[c];
    (in ? inside_weight : outside_weight) += source.weight;
  }
  std::array<float, 3> result = {0, 128, 128};
  const float weight = inside_weight > 0 ? inside_weight : outside_weight;
  if (!(weight > 0)) return result;
  for (std::size_t c = 0; c < 3; ++c) result[c] = (inside_weight > 0 ? inside : outside)[c] / weight;
  return result;
}

std::uint8_t Rounded(float value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F))); }

double CoarseError(const std::vector<PlaneSource>& sources, const PictureView& target, const LevelsInView& in_target,
                   double depth_in_ref) {
  double sum = 0;
  for (int y = 0; y < target.camera.height; y += 2) {
    for (int x = 0; x < target.camera.width; x += 2) {
      const double inverse = std::max(in_target.InverseDepth(x, y, depth_in_ref), 0.0);
      const float luma = ColourAt(sources, x, y, inverse)[0];
      const double difference = static_cast<double>(luma) - (*target.picture)(x, y).y;
      sum += difference * difference;
    }
  }
  return sum;
}

Status Check(const PictureView& view) {
  if (view.picture != nullptr && view.picture->width() == view.camera.width &&
      view.picture->height() == view.camera.height) {
    return {};
  }
  return InvalidArgument("view '" + view.camera.name + "' lacks a picture of its camera's size, " +
                         std::to_string(view.camera.width) + "x" + std::to_string(view.camera.height));
}

}  // namespace

YcbcrImage SynthesizeOnPlane(const std::vector<PictureView>& sources, const Camera& target, const DepthLevels& levels,
                             double depth_in_ref) {
  const std::vector<PlaneSource> prepared = Prepare(sources, target);
  const LevelsInView in_target(target, levels);
  YcbcrImage picture(target.width, target.height);
  for (int y = 0; y < target.height; ++y) {
    for (int x = 0; x < target.width; ++x) {
      const double inverse = std::max(in_target.InverseDepth(x, y, depth_in_ref), 0.0);
      const std::array<float, 3> colour = ColourAt(prepared, x, y, inverse);
      picture(x, y) = {Rounded(colour[0]), Rounded(colour[1]), Rounded(colour[2]), 0};
    }
  }
  return picture;
}

Result<SinglePlane> BestSinglePlane(const std::vector<PictureView>& sources, const PictureView& target,
                                    const DepthLevels& levels, int planes) {
  if (sources.empty()) return InvalidArgument("view '" + target.camera.name + "' has no source views");
  if (planes < 1) return InvalidArgument("planes is " + std::to_string(planes) + ", expected at least 1");
  DEPTHFARM_RETURN_IF_ERROR(Check(target));
  for (const PictureView& source : sources) DEPTHFARM_RETURN_IF_ERROR(Check(source));

  const std::vector<PlaneSource> prepared = Prepare(sources, target.camera);
  const LevelsInView in_target(target.camera, levels);
  SinglePlane best;
  double best_error = 0;
  for (int i = 0; i < planes; ++i) {
    const double share = planes > 1 ? static_cast<double>(i) / (planes - 1) : 0.5;
    const double depth = 1.0 / (1.0 / levels.z_far() + (1.0 / levels.z_near() - 1.0 / levels.z_far()) * share);
    const double error = CoarseError(prepared, target, in_target, depth);
    if (i > 0 && error >= best_error) continue;
    best_error = error;
    best.depth_in_ref = depth;
  }
  best.picture = SynthesizeOnPlane(sources, target.camera, levels, best.depth_in_ref);
  best.error = MeasureLumaError(best.picture, *target.picture);
  return best;
}

}  // namespace depthfarm
