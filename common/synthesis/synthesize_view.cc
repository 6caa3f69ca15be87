#include "common/synthesis/synthesize_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "common/geometry/reprojection.h"
#include "common/synthesis/fill_holes.h"
#include "common/synthesis/sample_surface.h"

namespace depthfarm {
namespace {

// One source drawn into the target.
struct Warped {
  Surface surface;
  const YcbcrImage* picture = nullptr;
  Grid<float> inverse_depth;  // target size
  Reprojection source_from_target;
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

// Where the surface points that a row of the target shows lie in one source.
class RowInSource {
 public:
  explicit RowInSource(const Warped& source)
      : source_(source),
        x_(Width()),
        y_(Width()),
        own_inverse_depth_(Width()),
        depth_ratio_(Width()),
        inverse_depth_(source.inverse_depth.row(0)) {}

  // Plain loops over arrays: they are vectorised.
  void Locate(int row) {
    inverse_depth_ = source_.inverse_depth.row(row);
    const Eigen::Matrix3d& m = source_.source_from_target.m();
    const Eigen::Vector3d& e = source_.source_from_target.e();
    const double row_x = m(0, 1) * row + m(0, 2);
    const double row_y = m(1, 1) * row + m(1, 2);
    const double row_z = m(2, 1) * row + m(2, 2);
    const double step_x = m(0, 0), step_y = m(1, 0), step_z = m(2, 0);
    const double e_x = e[0], e_y = e[1], e_z = e[2];
    float* const x_out = x_.data();
    float* const y_out = y_.data();
    float* const own_out = own_inverse_depth_.data();
    float* const ratio_out = depth_ratio_.data();
    const int width = source_.inverse_depth.width();
    for (int x = 0; x < width; ++x) {
      const auto inverse = static_cast<double>(inverse_depth_[x]);
      const double qz = step_z * x + row_z + e_z * inverse;
      const bool seen = inverse > 0 && qz > 0;
      const double w = 1.0 / (seen ? qz : 1.0);
      x_out[x] = static_cast<float>((step_x * x + row_x + e_x * inverse) * w);
      y_out[x] = static_cast<float>((step_y * x + row_y + e_y * inverse) * w);
      own_out[x] = static_cast<float>(seen ? inverse * w : 0.0);
      ratio_out[x] = static_cast<float>(qz);
    }
  }

  // 1/z' along the target's axis of what the source shows at a pixel of the row; 0 = nothing.
  [[nodiscard]] float InverseDepth(std::size_t i) const { return inverse_depth_[i]; }
  [[nodiscard]] bool Shows(std::size_t i) const { return own_inverse_depth_[i] > 0; }
  [[nodiscard]] float weight() const { return source_.weight; }

  [[nodiscard]] SampledColour Sample(std::size_t i) const {
    return SampleSurface(*source_.picture, source_.surface, x_[i], y_[i], own_inverse_depth_[i]);
  }

  // Whether a pixel's surface lies within `tolerance` source pixels of a point on the same ray at `nearest` = 1/z'.
  // From X = (q + e / z') / q_z the two points are |(e_x - X e_z, e_y - Y e_z)| (1/z' difference) / q_z(nearest) apart.
  [[nodiscard]] bool Agrees(std::size_t i, float nearest, float tolerance) const {
    const Eigen::Vector3d& e = source_.source_from_target.e();
    const auto ez = static_cast<float>(e[2]);
    const float step = nearest - inverse_depth_[i];
    const float bound = tolerance * (depth_ratio_[i] + ez * step);
    const float dx = (static_cast<float>(e[0]) - x_[i] * ez) * step;
    const float dy = (static_cast<float>(e[1]) - y_[i] * ez) * step;
    return bound > 0 && dx * dx + dy * dy <= bound * bound;
  }

 private:
  [[nodiscard]] std::size_t Width() const { return static_cast<std::size_t>(source_.inverse_depth.width()); }

  const Warped& source_;
  std::vector<float> x_;  // pixel of the source picture
  std::vector<float> y_;
  std::vector<float> own_inverse_depth_;  // 1/z along the source's axis
  std::vector<float> depth_ratio_;        // z / z'
  const float* inverse_depth_;            // of the row
};

// Blends what the sources show, one row of the target after the other.
class Blender {
 public:
  Blender(const std::vector<Warped>& warped, const SynthesisParams& params)
      : rows_(warped.begin(), warped.end()), tolerance_(static_cast<float>(params.agreement_px)) {}

  void GoTo(int y) {
    for (RowInSource& row : rows_) row.Locate(y);
  }

  // Sets the colour and the z of a pixel of the row, unless it is a hole.
  Known Blend(int x, Ycbcr& colour, float& z) const {
    const auto i = static_cast<std::size_t>(x);
    float nearest = 0;
    for (const RowInSource& row : rows_) nearest = std::max(nearest, row.InverseDepth(i));
    if (nearest == 0) return Known::kHole;
    Sum clean;
    Sum doubtful;
    for (const RowInSource& row : rows_) {
      if (!row.Shows(i) || (row.InverseDepth(i) < nearest && !row.Agrees(i, nearest, tolerance_))) continue;
      const SampledColour sample = row.Sample(i);
      (sample.clean ? clean : doubtful).Add(sample.colour, row.InverseDepth(i), row.weight());
    }
    const bool is_clean = clean.weight > 0;
    if (!is_clean && !(doubtful.weight > 0)) return Known::kHole;
    (is_clean ? clean : doubtful).Mean(colour, z);
    return is_clean ? Known::kClean : Known::kDoubtful;
  }

 private:
  struct Sum {
    Colour colour = {};
    float inverse_depth = 0;
    float weight = 0;

    void Add(const Colour& sample, float inverse, float w) {
      for (std::size_t c = 0; c < colour.size(); ++c) colour[c] += w * sample[c];
      inverse_depth += w * inverse;
      weight += w;
    }
    void Mean(Ycbcr& mean, float& z) const {
      const float scale = 1 / weight;
      const auto rounded = [scale](float value) {
        const float half_up = value * scale + 0.5F;  // values are not negative; std::lround is a call
        return static_cast<std::uint8_t>(half_up);
      };
      // Written where they stay: a pixel put together on the stack waits for its bytes.
      mean.y = rounded(colour[0]);
      mean.cb = rounded(colour[1]);
      mean.cr = rounded(colour[2]);
      z = weight / inverse_depth;
    }
  };

  std::vector<RowInSource> rows_;
  float tolerance_;
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
    warped.push_back({std::move(surface), sources[i].picture, std::move(inverse_depth),
                      Reprojection(target, sources[i].camera), static_cast<float>(weights[i])});
  }

  SynthesizedView result;
  result.picture = YcbcrImage(target.width, target.height);
  result.holes = Grid<std::uint8_t>(target.width, target.height);
  result.depth = DepthMap(target.width, target.height);
  Grid<Known> kinds(target.width, target.height, Known::kHole);
  Blender blender(warped, params);
  for (int y = 0; y < target.height; ++y) {
    blender.GoTo(y);
    Known* const known = kinds.row(y);
    Ycbcr* const colours = result.picture.row(y);
    float* const depth = result.depth.row(y);
    std::uint8_t* const holes = result.holes.row(y);
    for (int x = 0; x < target.width; ++x) {
      known[x] = blender.Blend(x, colours[x], depth[x]);
      holes[x] = known[x] == Known::kHole ? 1 : 0;
    }
  }
  FillHoles(kinds, result.picture, result.depth);
  return result;
}

}  // namespace depthfarm
