#include "worker/refinement/region_plane.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stop_token>

#include "tests/worker/refinement/plain_scene.h"

namespace depthfarm {
namespace {

RefinedView Decided(const PlainScene& scene, RefinedView view, const std::stop_token& stop = {}) {
  const std::vector<PlainRegion> regions = FindPlainRegions(scene.segments, scene.Plain(), view);
  const std::vector<OtherView> others = scene.Others();
  DecidePlainRegions(scene.picture, scene.segments, regions, others, nullptr, view, stop);
  return view;
}

// Depth of the view at the centres of the board's segments.
void ExpectBoardAt(const PlainScene& scene, const RefinedView& view, double u) {
  for (std::size_t s = 0; s < view.num_segments(); ++s) {
    const auto [x, y] = scene.segments.centers[s];
    if (!PlainScene::OnBoard(x, y) || PlainScene::AtCorner(x, y)) continue;
    EXPECT_NEAR(view.planes[s].At(x, y), u, 0.2) << x << "," << y;
  }
}

// A plate behind the wall is cheap for the cut and looks right from the middle of it.
TEST(DecidePlainRegions, ABoardOnAWallHasTheWallsDepth) {
  const PlainScene scene(PlainScene::kWall);
  for (const double guess : {2.0, 3.0, 6.0}) ExpectBoardAt(scene, Decided(scene, scene.View(guess)), PlainScene::kWall);
}

TEST(DecidePlainRegions, ABoardBeforeAWallStaysThere) {
  const PlainScene scene(9);
  ExpectBoardAt(scene, Decided(scene, scene.View(9)), 9);
}

// Beside a rod the wall is hidden in one view or the other, so the rod's depth fits better there than the true one.
TEST(DecidePlainRegions, ABoardBehindARodDoesNotTakeItsDepth) {
  const PlainScene scene(PlainScene::kWall, true);
  const RefinedView decided = Decided(scene, scene.View(PlainScene::kRod - 0.2));
  int board = 0;
  for (std::size_t s = 0; s < decided.num_segments(); ++s) {
    const auto [x, y] = scene.segments.centers[s];
    if (!PlainScene::OnBoard(x, y) || PlainScene::AtCorner(x, y) || (x >= 55 && x < 68)) continue;
    EXPECT_NEAR(decided.planes[s].At(x, y), PlainScene::kWall, 0.2) << x << "," << y;
    ++board;
  }
  EXPECT_GT(board, 60);
}

// The cut knows the wall on levels alone, here above and below where it is.
TEST(DecidePlainRegions, ABoardOnAWallThatIsBetweenTwoLevelsIsBetweenThemToo) {
  const PlainScene scene(PlainScene::kWall);
  RefinedView view = scene.View(3);
  for (SegmentIndex s = 0; s < view.num_segments(); ++s) {
    const auto [x, y] = scene.segments.centers[s];
    if (!PlainScene::OnBoard(x, y)) view.planes[s].c = s % 4 == 0 ? 3.45F : 4.45F;
  }
  ExpectBoardAt(scene, Decided(scene, view), PlainScene::kWall);
}

// From the other side there is a shadow along one edge of the board: it does not fit where it is, and farther away the
// wall would hide what does not fit.
TEST(DecidePlainRegions, WhatIsHiddenOnOneOfTwoPlanesSpeaksForNeither) {
  constexpr int kEdge = 4;  // pixels
  PlainScene scene(PlainScene::kWall);
  const auto on_board = [](int x, int y) { return PlainScene::OnBoard(x + PlainScene::kWall, y); };
  YcbcrImage& colours = scene.colours.front();
  InverseDepthMap& map = scene.maps.front();
  for (int y = 0; y < PlainScene::kHeight; ++y) {
    for (int x = 0; x < PlainScene::kWidth; ++x) {
      const bool at_right = !on_board(x + kEdge, y);
      if (on_board(x, y) && at_right) colours(x, y).y -= 70;
      if (at_right || !on_board(x - kEdge, y) || !on_board(x, y - kEdge) || !on_board(x, y + kEdge))
        map(x, y) = PlainScene::kWall;
    }
  }
  RefinedView view = scene.View(2);
  const std::vector<PlainRegion> regions = FindPlainRegions(scene.segments, scene.Plain(), view);
  DecidePlainRegions(scene.picture, scene.segments, regions, std::vector{scene.Others().front()}, nullptr, view);
  ExpectBoardAt(scene, view, PlainScene::kWall);
}

// A view that fits nowhere, as of another exposure, sees the board where it is and not behind the wall.
TEST(DecidePlainRegions, TwoPlanesAreComparedInTheViewsThatSeeBoth) {
  PlainScene scene(PlainScene::kWall);
  for (int y = 0; y < PlainScene::kHeight; ++y) {
    for (int x = 0; x < PlainScene::kWidth; ++x) {
      scene.colours.front()(x, y).y = static_cast<std::uint8_t>(scene.colours.front()(x, y).y / 2);
      scene.maps.front()(x, y) = PlainScene::kWall;
    }
  }
  ExpectBoardAt(scene, Decided(scene, scene.View(2)), PlainScene::kWall);
}

// One view sees the board where it is, not on the wall; another one, far away, what is on the wall, and that is not it.
TEST(DecidePlainRegions, OfTwoPlanesEachIsJudgedByTheViewsThatSeeItWhereNoneSeesBoth) {
  constexpr double kBoard = 9;
  PlainScene scene(kBoard);
  scene.pairs.back().e.x() = -10;
  for (int y = 0; y < PlainScene::kHeight; ++y) {
    for (int x = 0; x < PlainScene::kWidth; ++x) {
      scene.maps.front()(x, y) = (PlainScene::kWall + kBoard) / 2;
      scene.colours.back()(x, y) = {60, 128, 128};
    }
  }
  ExpectBoardAt(scene, Decided(scene, scene.View(kBoard)), kBoard);
}

TEST(DecidePlainRegions, KeptSegmentsStay) {
  const PlainScene scene(PlainScene::kWall);
  RefinedView view = scene.View(2);
  view.kept.assign(view.kept.size(), 1);
  EXPECT_EQ(Decided(scene, view), view);
}

TEST(DecidePlainRegions, EndsEarlyWhenAskedTo) {
  const PlainScene scene(PlainScene::kWall);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(Decided(scene, scene.View(2), stop.get_token()), scene.View(2));
}

}  // namespace
}  // namespace depthfarm
