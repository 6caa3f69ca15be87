#include "worker/refinement/plane_solver.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

// Segments in a row, ten pixels apart, of one colour.
SegmentMap Row(int count) {
  SegmentMap map;
  for (int s = 0; s < count; ++s) {
    map.centers.push_back({10 * s, 5});
    map.means.push_back({100 * kMeanColorScale, 128 * kMeanColorScale, 128 * kMeanColorScale});
    if (s > 0) map.adjacency.push_back({static_cast<SegmentIndex>(s - 1), static_cast<SegmentIndex>(s)});
  }
  return map;
}

RefinedView Flat(int count, float u) {
  return {.planes = std::vector<SlantedPlane>(static_cast<std::size_t>(count), {0, 0, u}),
          .kept = std::vector<std::uint8_t>(static_cast<std::size_t>(count)),
          .plane_of_pixel = {}};
}

double AtCentre(const SegmentMap& map, const RefinedView& view, std::size_t s) {
  return view.planes[s].At(map.centers[s].x, map.centers[s].y);
}

TEST(SolvePlanes, WithoutDataStaysWhereItIs) {
  const SegmentMap map = Row(5);
  RefinedView view = Flat(5, 3);
  SolvePlanes(map, std::vector<NormalEquations>(5), 1, view);
  for (std::size_t s = 0; s < 5; ++s) EXPECT_NEAR(AtCentre(map, view, s), 3, 1e-4);
}

TEST(SolvePlanes, FollowsStrongDataByAPixelAtMost) {
  const SegmentMap map = Row(1);
  std::vector<NormalEquations> data(1);
  data[0].h = {1e4, 0, 0, 1e4, 0, 1e4};
  data[0].rhs = {0, 0, 0.4e4};
  RefinedView view = Flat(1, 3);
  SolvePlanes(map, data, 1, view);
  EXPECT_NEAR(AtCentre(map, view, 0), 3.4, 1e-4);
  data[0].rhs = {0, 0, 7e4};
  view = Flat(1, 3);
  SolvePlanes(map, data, 1, view);
  EXPECT_NEAR(AtCentre(map, view, 0), 4, 1e-4);
}

TEST(SolvePlanes, ASlantOfTheDataSpreadsToSegmentsWithout) {
  const SegmentMap map = Row(3);
  std::vector<NormalEquations> data(3);
  for (const std::size_t s : {0, 2}) data[s].h = {1e6, 0, 0, 1e6, 0, 1e6};
  RefinedView view = Flat(3, 3);
  view.planes[0] = {0.02F, 0, 3};  // one slanted wall ...
  view.planes[2] = {0.02F, 0, 3};
  view.planes[1] = {0, 0, 3.1F};  // ... and a segment that does not know it yet
  SolvePlanes(map, data, 1, view);
  EXPECT_NEAR(AtCentre(map, view, 1), 3.2, 0.02);
  EXPECT_NEAR(view.planes[1].a, 0.02, 0.004);
}

TEST(SolvePlanes, DoesNotBridgeAJump) {
  const SegmentMap map = Row(2);
  std::vector<NormalEquations> data(2);
  for (NormalEquations& equations : data) equations.h = {100, 0, 0, 100, 0, 100};
  RefinedView view = Flat(2, 3);
  view.planes[1].c = 9;
  SolvePlanes(map, data, 0.2, view);
  EXPECT_NEAR(AtCentre(map, view, 0), 3, 0.02);
  EXPECT_NEAR(AtCentre(map, view, 1), 9, 0.02);
}

TEST(SolvePlanes, KeptSegmentsStayToTheBitAndHoldTheirNeighbours) {
  const SegmentMap map = Row(3);
  std::vector<NormalEquations> data(3);
  data[1].h = {1, 0, 0, 1, 0, 1};
  data[1].rhs = {0, 0, 0.5};
  RefinedView view = Flat(3, 3.3F);
  view.kept = {1, 0, 1};
  SolvePlanes(map, data, 1, view);
  EXPECT_EQ(view.planes[0], (SlantedPlane{0, 0, 3.3F}));
  EXPECT_EQ(view.planes[2], (SlantedPlane{0, 0, 3.3F}));
  EXPECT_NEAR(AtCentre(map, view, 1), 3.3, 0.01);
}

}  // namespace
}  // namespace depthfarm
