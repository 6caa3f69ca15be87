#include "worker/refinement/known_costs.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(KnownCosts, APlaneAtAPixelKeepsItsEntryAndCost) {
  KnownCosts known(4, 3);
  const auto first = known.EntryOf(1, 2, 7);
  known.Set(first, 0.25);
  const auto other_pixel = known.EntryOf(3, 0, 7);
  known.Set(other_pixel, 0.5);
  const auto other_plane = known.EntryOf(1, 2, 0);
  known.Set(other_plane, 0.75);
  EXPECT_EQ(known.size(), 3);
  EXPECT_EQ(known.EntryOf(1, 2, 7), first);
  EXPECT_EQ(known.EntryOf(3, 0, 7), other_pixel);
  EXPECT_EQ(known.EntryOf(1, 2, 0), other_plane);
  EXPECT_EQ(known.size(), 3);
  EXPECT_EQ(known[first].value, 0.25);
  EXPECT_EQ(known[other_pixel].value, 0.5);
  EXPECT_EQ(known[other_plane].value, 0.75);
}

TEST(KnownCosts, EntriesAreInTheOrderInWhichTheyWereAskedFor) {
  KnownCosts known(4, 3);
  for (PlaneIndex plane = 0; plane < 5; ++plane) EXPECT_EQ(known.EntryOf(3, 2, 4 - plane), plane);
  EXPECT_EQ(known[2].plane, 2);
  EXPECT_EQ(known.PlaceOf(2).x, 3);
  EXPECT_EQ(known.PlaceOf(2).y, 2);
}

}  // namespace
}  // namespace depthfarm
