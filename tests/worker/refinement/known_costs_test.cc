#include "worker/refinement/known_costs.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(KnownCosts, KnowsNothingAtFirst) {
  const KnownCosts known(4, 3);
  EXPECT_EQ(known.Find(0, 0, 0), std::nullopt);
  EXPECT_EQ(known.Find(3, 2, 7), std::nullopt);
}

TEST(KnownCosts, KeepsEachPixelsOwn) {
  KnownCosts known(4, 3);
  known.Keep(1, 2, 7, 0.25);
  known.Keep(3, 0, 7, 0.5);
  known.Keep(1, 2, 0, 0.75);
  EXPECT_EQ(known.Find(1, 2, 7), 0.25);
  EXPECT_EQ(known.Find(3, 0, 7), 0.5);
  EXPECT_EQ(known.Find(1, 2, 0), 0.75);
  EXPECT_EQ(known.Find(3, 0, 0), std::nullopt);
  EXPECT_EQ(known.Find(2, 1, 7), std::nullopt);
}

TEST(KnownCosts, ForgetsTheOldestOfAPixel) {
  KnownCosts known(1, 1);
  constexpr PlaneIndex kCount = KnownCosts::kKept + 3;
  for (PlaneIndex plane = 0; plane < kCount; ++plane) known.Keep(0, 0, plane, plane);
  for (PlaneIndex plane = 0; plane < 3; ++plane) EXPECT_EQ(known.Find(0, 0, plane), std::nullopt);
  for (PlaneIndex plane = 3; plane < kCount; ++plane) EXPECT_EQ(known.Find(0, 0, plane), plane);
}

}  // namespace
}  // namespace depthfarm
