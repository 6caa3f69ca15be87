#include "common/synthesis/synthesize_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/geometry/reprojection.h"
#include "common/synthesis/fill_holes.h"
#include "common/synthesis/sample_surface.h"

namespace depthfarm {
namespace {

// One source drawn into the target.
struct Warped {
  Surface surface;
  Grid<float> inverse_depth;  // target size
  Reprojection source_from_target;
  const YcbcrImage* picture = nullptr;
  float weight = 0;
};

Status CheckSource(const SourceView& source) {
  const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  const std::string expected = size(source.camera.width, source.camera.height);
  if (source.picture == nullptr || source.depth == nullptr) {
    return InvalidArgument("source view '" + source.camera.name + "' lacks its picture or its depth");
  }
  if (source.picture->width() != source.camera.width || source.picture->height() != source.camera.height) {
    return InvalidArgument("source view '" + source.camera.name + "': the picture is " +
                           size(source.picture->width(), source.picture->height()) + ", the camera " + expected);
  }
  if (source.depth->width() != source.camera.width || source.depth->height() != source.camera.height) {
    return InvalidArgument("source view '" + source.camera.name + "': the depth map is " +
                           size(source.depth->width(), source.depth->height()) + ", the camera " + expected);
  }
  return {};
}

// Blends what the sources show at one target pixel.
class Blender {
 public:
  Blender(const std::vector<Warped>& warped, const SynthesisParams& params)
      : warped_(warped), agreement_px_(params.agreement_px) {}

  struct Pixel {
    Known known = Known::kHole;
    Ycbcr colour;
    float z = 0;
  };

  [[nodiscard]] Pixel Blend(int x, int y) const {
    float nearest = 0;
    for (const Warped& source : warped_) nearest = std::max(nearest, source.inverse_depth(x, y));
    if (nearest == 0) return {};
    Sum clean;
    Sum doubtful;
    for (const Warped& source : warped_) {
      const float inverse = source.inverse_depth(x, y);
      if (inverse == 0) continue;
      const Reprojection::Projected p = source.source_from_target.Project(x, y, static_cast<double>(inverse));
      if (!(p.depth_per_source > 0)) continue;
      if (inverse < nearest && !Agrees(source, p, x, y, nearest)) continue;
      const double own_inverse = static_cast<double>(inverse) / p.depth_per_source;
      const SampledColour colour = SampleSurface(*source.picture, source.surface, p.x, p.y, own_inverse);
      (colour.clean ? clean : doubtful).Add(colour, inverse, source.weight);
    }
    if (clean.weight > 0) return clean.Mean(Known::kClean);
    if (doubtful.weight > 0) return doubtful.Mean(Known::kDoubtful);
    return {};
  }

 private:
  struct Sum {
    std::array<float, 3> ycbcr = {};
    float inverse_depth = 0;
    float weight = 0;

    void Add(const SampledColour& colour, float inverse, float w) {
      for (std::size_t c = 0; c < 3; ++c) ycbcr[c] += w * colour.ycbcr[c];
      inverse_depth += w * inverse;
      weight += w;
    }
    [[nodiscard]] Pixel Mean(Known known) const {
      const auto rounded = [this](float value) { return static_cast<std::uint8_t>(value / weight + 0.5F); };
      return {known, {rounded(ycbcr[0]), rounded(ycbcr[1]), rounded(ycbcr[2]), 0}, weight / inverse_depth};
    }
  };

  // Whether the surface of `source`, seen there at `own`, is the nearest one up to the tolerance.
  [[nodiscard]] bool Agrees(const Warped& source, const Reprojection::Projected& own, int x, int y,
                            float nearest) const {
    const Reprojection::Projected other = source.source_from_target.Project(x, y, static_cast<double>(nearest));
    const double dx = other.x - own.x;
    const double dy = other.y - own.y;
    return other.depth_per_source > 0 && dx * dx + dy * dy <= agreement_px_ * agreement_px_;
  }

  const std::vector<Warped>& warped_;
  double agreement_px_;
};

}  // namespace

std::vector<double> NearnessWeights(const std::vector<Camera>& sources, const Camera& target) {
  const Eigen::Vector3d center = CenterInWorld(target);
  std::vector<double> weights;
  double farthest = 0;
  for (const Camera& source : sources) {
    const Eigen::Vector3d step = CenterInWorld(source) - center;
    weights.push_back(std::sqrt(OrderedDot(step, step)));
    farthest = std::max(farthest, weights.back());
  }
  // A source at the target itself gets (nearly) all the weight instead of an infinite one.
  const double floor = farthest > 0 ? 1e-6 * farthest : 1.0;
  double sum = 0;
  for (double& weight : weights) {
    weight = 1.0 / std::max(weight, floor);
    sum += weight;
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

Result<SynthesizedView> SynthesizeView(const std::vector<SourceView>& sources, const Camera& target,
                                       const SynthesisParams& params) {
  if (sources.empty()) return InvalidArgument("view '" + target.name + "' cannot be synthesised from no source view");
  DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(target));
  std::vector<Camera> cameras;
  for (const SourceView& source : sources) {
    DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(source.camera));
    DEPTHFARM_RETURN_IF_ERROR(CheckSource(source));
    cameras.push_back(source.camera);
  }
  const std::vector<double> weights = NearnessWeights(cameras, target);
  std::vector<Warped> warped;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    Surface surface = ProjectSurface(*sources[i].depth, sources[i].camera, target, params.surface);
    Grid<float> inverse_depth = RenderInverseDepth(surface, target.width, target.height);
    warped.push_back({std::move(surface), std::move(inverse_depth), Reprojection(target, sources[i].camera),
                      sources[i].picture, static_cast<float>(weights[i])});
  }

  SynthesizedView result;
  result.picture = YcbcrImage(target.width, target.height);
  result.holes = Grid<std::uint8_t>(target.width, target.height);
  result.depth = DepthMap(target.width, target.height);
  Grid<Known> kinds(target.width, target.height, Known::kHole);
  const Blender blender(warped, params);
  for (int y = 0; y < target.height; ++y) {
    for (int x = 0; x < target.width; ++x) {
      const Blender::Pixel pixel = blender.Blend(x, y);
      kinds(x, y) = pixel.known;
      result.picture(x, y) = pixel.colour;
      result.depth(x, y) = pixel.z;
      result.holes(x, y) = pixel.known == Known::kHole ? 1 : 0;
    }
  }
  FillHoles(kinds, result.picture, result.depth);
  return result;
}

}  // namespace depthfarm
