#include "common/synthesis/sample_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

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

void Add(const Colour& colour, float weight, Colour& sum) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * colour[i];
}

struct Position {
  int x0 = 0;  // left and upper of the two nearest pixels each way
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  float tx = 0;  // 0 at x0, 1 at x1
  float ty = 0;
};

Position Clamped(int width, int height, float x, float y) {
  const float cx = std::min(std::max(x, 0.0F), static_cast<float>(width - 1));
  const float cy = std::min(std::max(y, 0.0F), static_cast<float>(height - 1));
  Position p;
  p.x0 = static_cast<int>(cx);
  p.y0 = static_cast<int>(cy);
  p.x1 = std::min(p.x0 + 1, width - 1);
  p.y1 = std::min(p.y0 + 1, height - 1);
  p.tx = cx - static_cast<float>(p.x0);
  p.ty = cy - static_cast<float>(p.y0);
  return p;
}

// A Colour in one register. GCC's and Clang's vector type: they do not find it by themselves in loops over four values.
using ColourVector = float __attribute__((vector_size(16)));

ColourVector Load(const Colour& colour) {
  ColourVector vector;
  std::memcpy(&vector, colour.data(), sizeof(vector));
  return vector;
}

Colour Cubic(const ColourGrid& picture, const Position& p) {
  const std::array<float, 4> wx = CubicWeights(p.tx);
  const std::array<float, 4> wy = CubicWeights(p.ty);
  const auto row = [&](int j) {
    const Colour* pixels = picture.row(p.y0 + j) + (p.x0 - 1);
    return wx[0] * Load(pixels[0]) + wx[1] * Load(pixels[1]) + wx[2] * Load(pixels[2]) + wx[3] * Load(pixels[3]);
  };
  ColourVector sum = wy[0] * row(-1) + wy[1] * row(0) + wy[2] * row(1) + wy[3] * row(2);
  constexpr ColourVector kBlack = {0, 0, 0, 0};
  constexpr ColourVector kWhite = {255, 255, 255, 255};
  sum = sum < kBlack ? kBlack : sum;
  sum = sum > kWhite ? kWhite : sum;
  Colour colour;
  std::memcpy(colour.data(), &sum, sizeof(sum));
  return colour;
}

// Near tears: bilinear over the pixels of the same surface.
SampledColour BesideTears(const ColourGrid& picture, const Surface& surface, const Position& p, float inverse_depth) {
  struct Tap {
    int x, y;
    float weight;
  };
  const Tap taps[] = {{p.x0, p.y0, (1 - p.tx) * (1 - p.ty)},
                      {p.x1, p.y0, p.tx * (1 - p.ty)},
                      {p.x0, p.y1, (1 - p.tx) * p.ty},
                      {p.x1, p.y1, p.tx * p.ty}};
  SampledColour result;
  float weight_sum = 0;
  float best_distance = -1;
  float clean_weight = 0;
  const Tap* best = &taps[0];
  for (const Tap& tap : taps) {
    const float own = surface.inverse_depth(tap.x, tap.y);
    if (own == 0) continue;
    const float distance = std::abs(own - inverse_depth) * surface.parallax(tap.x, tap.y);
    if (best_distance < 0 || distance < best_distance) {
      best_distance = distance;
      best = &tap;
    }
    if (distance > kSameSurfacePx) continue;
    weight_sum += tap.weight;
    Add(picture(tap.x, tap.y), tap.weight, result.colour);
    if ((surface.flags(tap.x, tap.y) & Surface::kBehindEdge) == 0) clean_weight += tap.weight;
  }
  // A position that lies almost wholly on foreign pixels would amplify a tiny share: take the likest pixel instead.
  if (weight_sum < 0.05F) {
    return {picture(best->x, best->y), (surface.flags(best->x, best->y) & Surface::kBehindEdge) == 0};
  }
  for (float& value : result.colour) value /= weight_sum;
  result.clean = clean_weight > 0.5F * weight_sum;
  return result;
}

}  // namespace

Colour SampleBilinear(const YcbcrImage& picture, double x, double y) {
  const Position p = Clamped(picture.width(), picture.height(), static_cast<float>(x), static_cast<float>(y));
  Colour sum = {};
  Add(ColourOf(picture(p.x0, p.y0)), (1 - p.tx) * (1 - p.ty), sum);
  Add(ColourOf(picture(p.x1, p.y0)), p.tx * (1 - p.ty), sum);
  Add(ColourOf(picture(p.x0, p.y1)), (1 - p.tx) * p.ty, sum);
  Add(ColourOf(picture(p.x1, p.y1)), p.tx * p.ty, sum);
  return sum;
}

SampledColour SampleSurface(const ColourGrid& picture, const Surface& surface, float x, float y, float inverse_depth) {
  const Position p = Clamped(picture.width(), picture.height(), x, y);
  if ((surface.flags(p.x0, p.y0) & Surface::kSmooth) != 0) return {Cubic(picture, p), true};
  return BesideTears(picture, surface, p, inverse_depth);
}

}  // namespace depthfarm
