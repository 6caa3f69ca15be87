#include "common/scene/texture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/hash.h"

namespace depthfarm {
namespace {

Eigen::Vector3d Point(int i) { return {Uniform(3, 2 * i, -5, 5), Uniform(3, 2 * i + 1, -5, 5), 0.37}; }

TEST(OctaveNoise, HasMeanZeroAndAboutUnitDeviation) {
  constexpr int kCount = 20000;
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = OctaveNoise(Point(i), 0.2, 0.005, 1);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.05);
  EXPECT_GT(std::sqrt(squares / kCount), 0.7);
  EXPECT_LT(std::sqrt(squares / kCount), 1.3);
}

TEST(OctaveNoise, VanishesWhereAPixelHidesTheCoarsestOctave) {
  for (int i = 0; i < 100; ++i) EXPECT_EQ(OctaveNoise(Point(i), 0.2, 0.2, 1), 0);
}

TEST(OctaveNoise, HoldsNoDetailFinerThanAPixel) {
  // Over a tenth of a pixel band-limited noise moves little; over three pixels it decorrelates.
  constexpr double kPixel = 0.01;
  constexpr int kCount = 2000;
  double near_change = 0;
  double far_change = 0;
  for (int i = 0; i < kCount; ++i) {
    const double here = OctaveNoise(Point(i), 0.08, kPixel, 1);
    near_change += std::abs(OctaveNoise(Point(i) + Eigen::Vector3d(0.1 * kPixel, 0, 0), 0.08, kPixel, 1) - here);
    far_change += std::abs(OctaveNoise(Point(i) + Eigen::Vector3d(3 * kPixel, 0, 0), 0.08, kPixel, 1) - here);
  }
  EXPECT_LT(near_change, 0.12 * far_change);
}

TEST(OctaveNoise, FadesContinuouslyWithPixelSize) {
  for (int i = 0; i < 200; ++i) {
    for (double footprint = 0.004; footprint < 0.2; footprint *= 1.1) {
      EXPECT_NEAR(OctaveNoise(Point(i), 0.2, footprint, 1), OctaveNoise(Point(i), 0.2, footprint * 1.0001, 1), 2e-3);
    }
  }
}

TEST(MaterialColour, PlainPaintIsTheSameEverywhere) {
  const Material plain{.pattern = Material::Pattern::kPlain, .base = Rgb(10, 20, 30), .contrast = 0};
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(MaterialColour(plain, Point(i), Point(i).head<2>(), 0.005), Rgb(10, 20, 30));
  }
}

}  // namespace
}  // namespace depthfarm
