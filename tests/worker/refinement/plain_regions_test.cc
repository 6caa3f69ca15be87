#include "worker/refinement/plain_regions.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/worker/refinement/plain_scene.h"

namespace depthfarm {
namespace {

TEST(PlainSegments, AreThoseWithoutTexture) {
  const PlainScene scene(PlainScene::kWall);
  const std::vector<std::uint8_t> plain = scene.Plain();
  int plain_on_wall = 0;
  for (std::size_t s = 0; s < plain.size(); ++s) {
    const auto [x, y] = scene.segments.centers[s];
    const bool well_inside = PlainScene::OnBoard(x - 5, y - 5) && PlainScene::OnBoard(x + 5, y + 5);
    const bool outside = !PlainScene::OnBoard(x, y);
    if (well_inside) {
      EXPECT_EQ(plain[s], 1) << x << "," << y;
    }
    if (outside) plain_on_wall += plain[s];
  }
  EXPECT_LT(plain_on_wall, 10);  // of 260
}

TEST(FindPlainRegions, TakesInTheSegmentsAtItsEdge) {
  const PlainScene scene(PlainScene::kWall);
  const RefinedView view = scene.View(2);
  const std::vector<PlainRegion> regions = FindPlainRegions(scene.segments, scene.Plain(), view);
  ASSERT_EQ(regions.size(), 1U);
  std::vector<std::uint8_t> inside(scene.segments.centers.size());
  for (const SegmentIndex s : regions[0].segments) inside[s] = 1;
  for (std::size_t s = 0; s < inside.size(); ++s) {
    const auto [x, y] = scene.segments.centers[s];
    EXPECT_EQ(inside[s] != 0, PlainScene::OnBoard(x, y) && !PlainScene::AtCorner(x, y)) << x << "," << y;
  }
  EXPECT_FALSE(regions[0].rim.empty());
  for (const SegmentIndex t : regions[0].rim) EXPECT_EQ(inside[t], 0);
  for (const SegmentIndex t : regions[0].behind) EXPECT_EQ(inside[t], 0);
}

TEST(FindPlainRegions, KeptSegmentsAreTheRimOfWhatIsNot) {
  const PlainScene scene(PlainScene::kWall);
  RefinedView view = scene.View(2);
  for (std::size_t s = 0; s < view.kept.size(); ++s) view.kept[s] = scene.segments.centers[s].x < 60 ? 1 : 0;
  const std::vector<PlainRegion> regions = FindPlainRegions(scene.segments, scene.Plain(), view);
  ASSERT_EQ(regions.size(), 1U);
  for (const SegmentIndex s : regions[0].segments) EXPECT_EQ(view.kept[s], 0);
  EXPECT_TRUE(std::any_of(regions[0].rim.begin(), regions[0].rim.end(), [&](SegmentIndex t) {
    return view.kept[t] != 0 && PlainScene::OnBoard(scene.segments.centers[t].x, scene.segments.centers[t].y);
  }));
}

TEST(FindPlainRegions, SmallOnesAreLeftToTheirSegments) {
  const PlainScene scene(PlainScene::kWall);
  std::vector<std::uint8_t> plain(scene.segments.centers.size());
  std::fill_n(plain.begin(), 11, 1);
  EXPECT_TRUE(FindPlainRegions(scene.segments, plain, scene.View(2)).empty());
}

TEST(Occluders, LeaveOutWhatIsPlainAndReachTwoPixelsFarther) {
  InverseDepthMap map(20, 10, 3);
  Grid<SegmentIndex> labels(20, 10, 0);
  for (int y = 0; y < 10; ++y) labels(10, y) = 1;
  const InverseDepthMap spread = Occluders(map, labels, std::vector<std::uint8_t>{1, 0});
  for (int x = 0; x < 20; ++x) EXPECT_EQ(spread(x, 5), x >= 8 && x <= 12 ? 3.0F : -1e9F) << x;
}

}  // namespace
}  // namespace depthfarm
