#include "common/synthesis/sample_surface.h"

#include <algorithm>
#include <cmath>

namespace depthfarm {
namespace {

// A pixel belongs to the sampled surface if its depth moves it by at most this many target pixels.
constexpr float kSameSurfacePx = 1.0F;

// Catmull-Rom weights of the four samples around a position `t` past the second one.
std::array<float, 4> CubicWeights(float t) {
  const float t2 = t * t;
  const float t3 = t2 * t;
  return {-0.5F * t3 + t2 - 0.5F * t, 1.5F * t3 - 2.5F * t2 + 1.0F, -1.5F * t3 + 2.0F * t2 + 0.5F * t,
          0.5F * t3 - 0.5F * t2};
}

void Add(const Ycbcr& pixel, float weight, std::array<float, 3>& sum) {
  sum[0] += weight * static_cast<float>(pixel.y);
  sum[1] += weight * static_cast<float>(pixel.cb);
  sum[2] += weight * static_cast<float>(pixel.cr);
}

struct Position {
  int x0 = 0;  // left and upper of the two nearest pixels each way
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  float tx = 0;  // 0 at x0, 1 at x1
  float ty = 0;
};

Position Clamped(const YcbcrImage& picture, double x, double y) {
  const double cx = std::clamp(x, 0.0, static_cast<double>(picture.width() - 1));
  const double cy = std::clamp(y, 0.0, static_cast<double>(picture.height() - 1));
  Position p;
  p.x0 = static_cast<int>(cx);
  p.y0 = static_cast<int>(cy);
  p.x1 = std::min(p.x0 + 1, picture.width() - 1);
  p.y1 = std::min(p.y0 + 1, picture.height() - 1);
  p.tx = static_cast<float>(cx - p.x0);
  p.ty = static_cast<float>(cy - p.y0);
  return p;
}

std::array<float, 3> Cubic(const YcbcrImage& picture, const Position& p) {
  const std::array<float, 4> wx = CubicWeights(p.tx);
  const std::array<float, 4> wy = CubicWeights(p.ty);
  std::array<float, 3> sum = {};
  for (int j = 0; j < 4; ++j) {
    const Ycbcr* row = picture.row(p.y0 - 1 + j) + (p.x0 - 1);
    std::array<float, 3> line = {};
    for (int i = 0; i < 4; ++i) Add(row[i], wx[static_cast<std::size_t>(i)], line);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += wy[static_cast<std::size_t>(j)] * line[c];
  }
  for (float& value : sum) value = std::clamp(value, 0.0F, 255.0F);
  return sum;
}

}  // namespace

SampledColour SampleBilinear(const YcbcrImage& picture, double x, double y) {
  const Position p = Clamped(picture, x, y);
  SampledColour result;
  Add(picture(p.x0, p.y0), (1 - p.tx) * (1 - p.ty), result.ycbcr);
  Add(picture(p.x1, p.y0), p.tx * (1 - p.ty), result.ycbcr);
  Add(picture(p.x0, p.y1), (1 - p.tx) * p.ty, result.ycbcr);
  Add(picture(p.x1, p.y1), p.tx * p.ty, result.ycbcr);
  return result;
}

SampledColour SampleSurface(const YcbcrImage& picture, const Surface& surface, double x, double y,
                            double inverse_depth) {
  const Position p = Clamped(picture, x, y);
  SampledColour result;
  if ((surface.flags(p.x0, p.y0) & Surface::kSmooth) != 0) {
    result.ycbcr = Cubic(picture, p);
    return result;
  }
  struct Tap {
    int x, y;
    float weight;
  };
  const Tap taps[] = {{p.x0, p.y0, (1 - p.tx) * (1 - p.ty)},
                      {p.x1, p.y0, p.tx * (1 - p.ty)},
                      {p.x0, p.y1, (1 - p.tx) * p.ty},
                      {p.x1, p.y1, p.tx * p.ty}};
  const float expected = static_cast<float>(inverse_depth);
  float weight_sum = 0;
  float best_distance = -1;
  float clean_weight = 0;
  const Tap* best = &taps[0];
  for (const Tap& tap : taps) {
    const float own = surface.inverse_depth(tap.x, tap.y);
    if (own == 0) continue;
    const float distance = std::abs(own - expected) * surface.parallax(tap.x, tap.y);
    if (best_distance < 0 || distance < best_distance) {
      best_distance = distance;
      best = &tap;
    }
    if (distance > kSameSurfacePx) continue;
    weight_sum += tap.weight;
    Add(picture(tap.x, tap.y), tap.weight, result.ycbcr);
    if ((surface.flags(tap.x, tap.y) & Surface::kBehindEdge) == 0) clean_weight += tap.weight;
  }
  // A position that lies almost wholly on foreign pixels would amplify a tiny share: take the likest pixel instead.
  if (weight_sum < 0.05F) {
    result.ycbcr = {};
    Add(picture(best->x, best->y), 1, result.ycbcr);
    result.clean = (surface.flags(best->x, best->y) & Surface::kBehindEdge) == 0;
    return result;
  }
  for (float& value : result.ycbcr) value /= weight_sum;
  result.clean = clean_weight > 0.5F * weight_sum;
  return result;
}

}  // namespace depthfarm
