#include "worker/refinement/jump_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace depthfarm {
namespace {

constexpr int kRadius = 4;

// Whether a pixel and the next in its row or column are more than `jump` apart.
bool IsJump(const InverseDepthMap& map, int x, int y, float jump) {
  return (x + 1 < map.width() && std::abs(map(x, y) - map(x + 1, y)) > jump) ||
         (y + 1 < map.height() && std::abs(map(x, y) - map(x, y + 1)) > jump);
}

Grid<std::uint8_t> PlainBand(const InverseDepthMap& map, float jump) {
  Grid<std::uint8_t> band(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (int dy = -kRadius; dy <= kRadius; ++dy)
        for (int dx = -kRadius; dx <= kRadius; ++dx)
          if (map.Contains(x + dx, y + dy) && IsJump(map, x + dx, y + dy, jump)) band(x, y) = 1;
    }
  }
  return band;
}

// A plain map of `u` with a few pixels that are `step` higher.
InverseDepthMap WithSpots(int width, int height, int spots, float step, unsigned seed) {
  std::mt19937 random(seed);
  InverseDepthMap map(width, height, 3);
  for (int i = 0; i < spots; ++i)
    map(static_cast<int>(random() % static_cast<unsigned>(width)),
        static_cast<int>(random() % static_cast<unsigned>(height))) += step;
  return map;
}

TEST(JumpBand, IsWhatIsNearJumps) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 30}, {30, 1}, {7, 3}, {96, 70}, {131, 40}}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const InverseDepthMap map = WithSpots(width, height, width * height / 700 + 1, 0.75, seed);
      Grid<std::uint8_t> plain = PlainBand(map, 0.5);
      // Of a small one much may be near a jump, and none is high enough then.
      if (4 * std::count(plain.values().begin(), plain.values().end(), 1) > width * height) plain = {width, height};
      for (const int threads : {1, 3})
        EXPECT_EQ(JumpBand(map, threads), plain) << width << "x" << height << " " << seed;
    }
  }
}

TEST(JumpBand, AJumpIsMoreThanHalfAPixel) {
  const InverseDepthMap map = WithSpots(64, 64, 1, 0.5, 1);
  EXPECT_EQ(JumpBand(map, 1), Grid<std::uint8_t>(64, 64));
}

TEST(JumpBand, InAThicketOnlyHigherJumpsCount) {
  InverseDepthMap map = WithSpots(64, 64, 400, 3, 1);  // all of it is near jumps of 3
  map(10, 10) += 20;
  EXPECT_EQ(JumpBand(map, 1), PlainBand(map, 4));
  map = WithSpots(64, 64, 400, 30, 1);  // no bound is high enough
  EXPECT_EQ(JumpBand(map, 1), PlainBand(map, 8));
}

}  // namespace
}  // namespace depthfarm
