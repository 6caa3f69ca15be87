#include "worker/refinement/other_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/worker/refinement/two_views.h"

namespace depthfarm {
namespace {

TEST(SeenIn, MovesByUAndTellsHowFast) {
  const TwoViews views(5);
  const auto seen = SeenIn(views.pair, views.there_map, 12, 7, 5);
  ASSERT_TRUE(seen.has_value());
  EXPECT_DOUBLE_EQ(seen->x, 7);
  EXPECT_DOUBLE_EQ(seen->y, 7);
  EXPECT_DOUBLE_EQ(seen->u_in_other, 5);
  EXPECT_DOUBLE_EQ(seen->dx, -1);
  EXPECT_DOUBLE_EQ(seen->dy, 0);
}

TEST(SeenIn, DerivativesAreThoseOfTheProjection) {
  TwoViews views(0);
  views.pair.m << 1.01, 0.02, -1, -0.01, 0.99, 2, 1e-4, -2e-4, 1;
  views.pair.e = {-1.1, 0.2, 3e-3};
  constexpr double kStep = 1e-4;
  const auto at = [&](double u) { return SeenIn(views.pair, views.there_map, 20, 15, u).value(); };
  EXPECT_NEAR(at(2).dx, (at(2 + kStep).x - at(2 - kStep).x) / (2 * kStep), 1e-7);
  EXPECT_NEAR(at(2).dy, (at(2 + kStep).y - at(2 - kStep).y) / (2 * kStep), 1e-7);
}

TEST(SeenIn, NothingOutsideBehindOrHidden) {
  TwoViews views(5);
  EXPECT_FALSE(SeenIn(views.pair, views.there_map, 4.9, 7, 5));
  EXPECT_TRUE(SeenIn(views.pair, views.there_map, 5, 7, 5));
  EXPECT_FALSE(SeenIn(views.pair, views.there_map, 20, 7, 3.9));  // more than a pixel behind what is seen there
  EXPECT_TRUE(SeenIn(views.pair, views.there_map, 20, 7, 4.1));
  views.pair.m(2, 2) = -1;
  EXPECT_FALSE(SeenIn(views.pair, views.there_map, 20, 7, 5));
}

TEST(Misfit, IsNoneAtTheTruthAndGrowsToOne) {
  const TwoViews views(5);
  const auto misfit = [&](double u) { return Misfit(ColourOf(views.own(20, 15)), views.Other(), 20, 15, u).value(); };
  EXPECT_LT(misfit(5), 1e-6);
  EXPECT_GT(misfit(5.5), misfit(5.1));
  EXPECT_GT(misfit(8), misfit(5.5));
  EXPECT_LE(misfit(8), 1);
}

TEST(MisfitInFreeSpace, IsHigherWhereTheOtherViewSeesThrough) {
  TwoViews views(5);
  const Colour own = ColourOf(views.own(20, 15));
  EXPECT_EQ(MisfitInFreeSpace(own, views.Other(), 20, 15, 5.5), Misfit(own, views.Other(), 20, 15, 5.5));
  const double in_mid_air = Misfit(own, views.Other(), 20, 15, 6.5).value();
  EXPECT_DOUBLE_EQ(MisfitInFreeSpace(own, views.Other(), 20, 15, 6.5).value(), std::min(1.0, 2 * in_mid_air + 0.03));
  views.there_map(14, 16) = 6;  // (20 - 6.5, 15) is the pixel (14, 15): one beside it is as near
  EXPECT_EQ(MisfitInFreeSpace(own, views.Other(), 20, 15, 6.5), in_mid_air);
}

TEST(MeasureNoise, IsTheFloorWhereAllFits) {
  const TwoViews views(5);
  EXPECT_EQ(MeasureNoise(views.own, FlatView(5).Map(), views.Other()), 1.5);
}

TEST(MeasureNoise, FindsTheDeviationOfTheNoise) {
  TwoViews views(5);
  std::uint32_t state = 1;
  const auto uniform = [&] {  // of deviation 6: width 6 * sqrt(12)
    state = state * 1664525U + 1013904223U;
    return (static_cast<double>(state >> 8) / (1 << 24) - 0.5) * 6 * std::sqrt(12.0);
  };
  for (Ycbcr& pixel : views.own.values())
    for (std::uint8_t* value : {&pixel.y, &pixel.cb, &pixel.cr})
      *value = static_cast<std::uint8_t>(std::lround(*value + uniform()));
  EXPECT_NEAR(MeasureNoise(views.own, FlatView(5).Map(), views.Other()), 6, 0.9);
}

}  // namespace
}  // namespace depthfarm
