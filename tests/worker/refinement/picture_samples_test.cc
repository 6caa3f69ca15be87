#include "worker/refinement/picture_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "worker/refinement/colour_weight.h"

namespace depthfarm {
namespace {

YcbcrImage AnyPicture(int width, int height) {
  YcbcrImage picture(width, height);
  std::uint32_t state = 7;
  const auto byte = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<std::uint8_t>(state >> 24);
  };
  for (Ycbcr& pixel : picture.values()) pixel = {byte(), byte(), byte(), byte()};
  return picture;
}

// By its definition, in floating point.
std::array<double, 4> BlurredPlainly(const YcbcrImage& picture, int x, int y) {
  constexpr std::array<double, 5> kTaps{1, 4, 6, 4, 1};
  std::array<double, 4> sum{};
  for (int j = -2; j <= 2; ++j) {
    for (int i = -2; i <= 2; ++i) {
      const Colour pixel =
          ColourOf(picture(std::clamp(x + i, 0, picture.width() - 1), std::clamp(y + j, 0, picture.height() - 1)));
      for (std::size_t c = 0; c < 4; ++c) sum[c] += kTaps[i + 2] * kTaps[j + 2] / 256 * pixel[c];
    }
  }
  return sum;
}

TEST(Blurred, IsExact) {
  for (const auto& [width, height] : {std::pair{13, 9}, std::pair{2, 2}, std::pair{3, 11}}) {
    YcbcrImage picture = AnyPicture(width, height);
    picture(0, 0) = picture(1, 0) = picture(0, 1) = picture(1, 1) = {255, 0, 255, 40};
    const FineImage blurred = Blurred(picture);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Colour colour = ColourOf(blurred(x, y));
        for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(colour[c], BlurredPlainly(picture, x, y)[c]) << x << "," << y;
      }
    }
  }
}

// Value by value, as one would write it.
template <typename Pixel>
Colour SampledPlainly(const Grid<Pixel>& picture, double x, double y) {
  const int x0 = std::min(static_cast<int>(x), picture.width() - 2);
  const int y0 = std::min(static_cast<int>(y), picture.height() - 2);
  const auto fx = static_cast<float>(x - x0);
  const auto fy = static_cast<float>(y - y0);
  Colour result{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = [&](int dx, int dy) { return ColourOf(picture(x0 + dx, y0 + dy))[i]; };
    const float upper = at(0, 0) + fx * (at(1, 0) - at(0, 0));
    const float lower = at(0, 1) + fx * (at(1, 1) - at(0, 1));
    result[i] = upper + fy * (lower - upper);
  }
  return result;
}

TEST(Sampler, IsBilinearToTheLastBitUpToTheLastPixel) {
  const YcbcrImage picture = AnyPicture(11, 7);
  const FineImage blurred = Blurred(picture);
  for (double y = 0; y <= 6; y += 0.375) {
    for (double x = 0; x <= 10; x += 0.15625) {
      const ColourVector sharp = PictureColours(picture).Between(x, y);
      const ColourVector smooth = PictureColours(blurred).Between(x, y);
      for (std::size_t i = 0; i < 4; ++i) {
        ASSERT_EQ(sharp[i], SampledPlainly(picture, x, y)[i]) << x << "," << y;
        ASSERT_EQ(smooth[i], SampledPlainly(blurred, x, y)[i]) << x << "," << y;
      }
    }
  }
}

TEST(ColourWeight, IsThatOfItsDefinition) {
  EXPECT_EQ(ColourWeight({1, 2, 3, 4}, {1, 2, 3, 4}), 1);
  EXPECT_GT(ColourWeight({0, 0, 0, 0}, {255, 255, 255, 255}), 0);
  volatile double falloff = 40;
  for (int d = 0; d <= 4 * 255; ++d) {
    const auto part = [&](int i) { return static_cast<std::uint8_t>(std::clamp(d - 255 * i, 0, 255)); };
    const double base = 1 / (1 + d / falloff);
    ASSERT_EQ(ColourWeight({part(0), 0, part(2), 0}, {0, part(1), 0, part(3)}), base * base * base * base) << d;
  }
}

}  // namespace
}  // namespace depthfarm
