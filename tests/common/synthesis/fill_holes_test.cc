#include "common/synthesis/fill_holes.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

Ycbcr Grey(int y) { return {static_cast<std::uint8_t>(y), 128, 128, 0}; }

TEST(FillHoles, TakesTheFartherSide) {
  YcbcrImage picture(9, 1, Grey(200));
  DepthMap depth(9, 1, 2.0F);
  Grid<Known> kinds(9, 1, Known::kClean);
  for (int x = 5; x < 9; ++x) {
    picture(x, 0) = Grey(50);
    depth(x, 0) = 8.0F;
  }
  for (int x = 3; x < 6; ++x) kinds(x, 0) = Known::kHole;
  FillHoles(kinds, picture, depth);
  for (int x = 3; x < 6; ++x) {
    EXPECT_EQ(picture(x, 0), Grey(50)) << x;
    EXPECT_FLOAT_EQ(depth(x, 0), 8.0F) << x;
  }
  EXPECT_EQ(picture(2, 0), Grey(200));
}

// The strip at the left was outside every source's view. Beside it stand a near panel (rows 0 to 2) and a far wall;
// what is next to the panel continues the panel, although the diagonals see the wall.
TEST(FillHoles, BeyondTheBorderContinuesWhatIsBesideIt) {
  YcbcrImage picture(9, 6, Grey(200));
  DepthMap depth(9, 6, 2.0F);
  Grid<Known> kinds(9, 6, Known::kClean);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 3; ++x) kinds(x, y) = Known::kHole;
    for (int x = 0; x < 9 && y > 2; ++x) {
      picture(x, y) = Grey(50);
      depth(x, y) = 8.0F;
    }
  }
  FillHoles(kinds, picture, depth);
  EXPECT_EQ(picture(2, 0), Grey(200));
  EXPECT_FLOAT_EQ(depth(2, 0), 2.0F);
  EXPECT_GT(picture(1, 1).y, 125);
  EXPECT_EQ(picture(2, 5), Grey(50));
}

// A slit at the top border, uncovered beside a near panel, still lies between panel and wall.
TEST(FillHoles, AHoleThatTouchesTheBorderMayLieBetween) {
  YcbcrImage picture(9, 4, Grey(200));
  DepthMap depth(9, 4, 2.0F);
  Grid<Known> kinds(9, 4, Known::kClean);
  for (int y = 0; y < 4; ++y) {
    for (int x = 5; x < 9; ++x) {
      picture(x, y) = Grey(50);
      depth(x, y) = 8.0F;
    }
  }
  for (int y = 0; y < 2; ++y) kinds(4, y) = kinds(3, y) = Known::kHole;
  FillHoles(kinds, picture, depth);
  for (int y = 0; y < 2; ++y) {
    for (int x = 3; x < 5; ++x) EXPECT_EQ(picture(x, y), Grey(50)) << x << ' ' << y;
  }
}

TEST(FillHoles, DoubtfulPixelsDoNotSpread) {
  YcbcrImage picture(5, 1, Grey(50));
  DepthMap depth(5, 1, 8.0F);
  Grid<Known> kinds(5, 1, Known::kClean);
  kinds(1, 0) = Known::kHole;
  kinds(2, 0) = Known::kDoubtful;
  picture(0, 0) = Grey(200);
  depth(0, 0) = 2.0F;
  picture(2, 0) = Grey(125);
  FillHoles(kinds, picture, depth);
  EXPECT_EQ(picture(1, 0), Grey(50));
  EXPECT_EQ(picture(2, 0), Grey(50));
}

TEST(FillHoles, DoubtfulPixelsServeWhereNothingElseIsKnown) {
  YcbcrImage picture(3, 1, Grey(70));
  DepthMap depth(3, 1, 8.0F);
  Grid<Known> kinds(3, 1, Known::kDoubtful);
  kinds(1, 0) = Known::kHole;
  picture(1, 0) = Grey(0);
  FillHoles(kinds, picture, depth);
  EXPECT_EQ(picture(0, 0), Grey(70));
  EXPECT_EQ(picture(1, 0), Grey(70));
}

TEST(FillHoles, WithoutAnythingKnownNothingChanges) {
  YcbcrImage picture(4, 3, Grey(9));
  DepthMap depth(4, 3, 0.0F);
  FillHoles(Grid<Known>(4, 3, Known::kHole), picture, depth);
  EXPECT_EQ(picture, YcbcrImage(4, 3, Grey(9)));
  EXPECT_EQ(depth, DepthMap(4, 3, 0.0F));
}

}  // namespace
}  // namespace depthfarm
