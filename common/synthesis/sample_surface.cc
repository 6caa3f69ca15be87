#include "common/synthesis/sample_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace depthfarm {
namespace {

// A pixel belongs to the sampled surface if its depth moves it by at most this many target pixels.
constexpr float kSameSurfacePx = 1.0F;

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

// A Colour in one register, and four pixels: GCC's and Clang's vector types, for they do not find them by themselves in
// loops over four values.
using ColourVector = float __attribute__((vector_size(16)));
using Bytes = std::uint8_t __attribute__((vector_size(16)));
using Words = std::uint16_t __attribute__((vector_size(16)));
using Quads = std::int32_t __attribute__((vector_size(16)));

struct FourColours {
  ColourVector a, b, c, d;
};

// Four neighbours of a row. Bytes are widened by putting zeros behind them: little-endian.
FourColours Load(const Ycbcr* pixels) {
  static_assert(sizeof(Ycbcr) == 4);
  Bytes bytes;
  std::memcpy(&bytes, pixels, sizeof(bytes));
  constexpr Bytes kZero = {};
  const Words ab = (Words)__builtin_shufflevector(bytes, kZero, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const Words cd =
      (Words)__builtin_shufflevector(bytes, kZero, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  constexpr Words kZeros = {};
  const auto low = [&](Words words) {
    return __builtin_convertvector((Quads)__builtin_shufflevector(words, kZeros, 0, 8, 1, 9, 2, 10, 3, 11),
                                   ColourVector);
  };
  const auto high = [&](Words words) {
    return __builtin_convertvector((Quads)__builtin_shufflevector(words, kZeros, 4, 12, 5, 13, 6, 14, 7, 15),
                                   ColourVector);
  };
  return {low(ab), high(ab), low(cd), high(cd)};
}

// Catmull-Rom weights of the four samples around a position `t` past the second one.
ColourVector CubicWeights(float t) {
  constexpr ColourVector kCubed = {-0.5F, 1.5F, -1.5F, 0.5F};
  constexpr ColourVector kSquared = {1.0F, -2.5F, 2.0F, -0.5F};
  constexpr ColourVector kLinear = {-0.5F, 0.0F, 0.5F, 0.0F};
  constexpr ColourVector kConstant = {0.0F, 1.0F, 0.0F, 0.0F};
  return ((kCubed * t + kSquared) * t + kLinear) * t + kConstant;
}

// (x0 + tx, y0 + ty); the 4 x 4 pixels around exist.
Colour Cubic(const YcbcrImage& picture, int x0, int y0, float tx, float ty) {
  const ColourVector wx = CubicWeights(tx);
  const ColourVector wy = CubicWeights(ty);
  const auto row = [&](int j) {
    const FourColours pixels = Load(picture.row(y0 + j) + (x0 - 1));
    return wx[0] * pixels.a + wx[1] * pixels.b + wx[2] * pixels.c + wx[3] * pixels.d;
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
SampledColour BesideTears(const YcbcrImage& picture, const Surface& surface, const Position& p, float inverse_depth) {
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
    Add(ColourOf(picture(tap.x, tap.y)), tap.weight, result.colour);
    if ((surface.flags(tap.x, tap.y) & Surface::kBehindEdge) == 0) clean_weight += tap.weight;
  }
  // A position that lies almost wholly on foreign pixels would amplify a tiny share: take the likest pixel instead.
  if (weight_sum < 0.05F) {
    return {ColourOf(picture(best->x, best->y)), (surface.flags(best->x, best->y) & Surface::kBehindEdge) == 0};
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

SampledColour SampleSurface(const YcbcrImage& picture, const Surface& surface, float x, float y, float inverse_depth) {
  if (x >= 0 && y >= 0 && x < static_cast<float>(picture.width()) && y < static_cast<float>(picture.height())) {
    const int x0 = static_cast<int>(x);
    const int y0 = static_cast<int>(y);
    if ((surface.flags(x0, y0) & Surface::kSmooth) != 0)
      return {Cubic(picture, x0, y0, x - static_cast<float>(x0), y - static_cast<float>(y0)), true};
  }
  return BesideTears(picture, surface, Clamped(picture.width(), picture.height(), x, y), inverse_depth);
}

}  // namespace depthfarm
