#include "common/quality/masks.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace depthfarm {
namespace {

TEST(Masks, DilationIsASquareCutAtTheBorder) {
  PixelMask mask(9, 7);
  mask(1, 3) = 1;
  const PixelMask dilated = Dilated(mask, 2);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) EXPECT_EQ(dilated(x, y), x <= 3 && y >= 1 && y <= 5 ? 1 : 0) << x << "," << y;
  }
  EXPECT_EQ(Dilated(mask, 0), mask);
}

TEST(Masks, BorderPixelsAreAFrame) {
  const PixelMask border = BorderPixels(10, 8, 3);
  EXPECT_EQ(std::count(border.values().begin(), border.values().end(), 1), 80 - 4 * 2);
  EXPECT_EQ(border(3, 3), 0);
  EXPECT_EQ(border(2, 3), 1);
}

TEST(Masks, ZonesAndInversion) {
  ZoneMap zones(4, 1);
  zones(1, 0) = 6;
  zones(2, 0) = 2;
  const PixelMask panel = PixelsOfZone(zones, 6);
  EXPECT_EQ(panel.values(), (std::vector<std::uint8_t>{0, 1, 0, 0}));
  EXPECT_EQ(Inverted(panel).values(), (std::vector<std::uint8_t>{1, 0, 1, 1}));
  EXPECT_DOUBLE_EQ(ShareSet(panel), 0.25);
}

}  // namespace
}  // namespace depthfarm
