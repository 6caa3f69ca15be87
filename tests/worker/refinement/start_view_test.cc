#include "worker/refinement/start_view.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace depthfarm {
namespace {

// Columns of a 4 x 2 picture as segments, of the given greys.
ViewAnalysis Columns(const std::vector<int>& greys) {
  ViewAnalysis analysis{.picture = YcbcrImage(4, 2), .segments = {}};
  SegmentMap& map = analysis.segments;
  map.labels = Grid<SegmentIndex>(4, 2);
  for (int x = 0; x < 4; ++x) {
    const int grey = greys[static_cast<std::size_t>(x)];
    for (int y = 0; y < 2; ++y) {
      map.labels(x, y) = static_cast<SegmentIndex>(x);
      analysis.picture(x, y) = {static_cast<std::uint8_t>(grey), 128, 128};
    }
    map.centers.push_back({x, 0});
    map.means.push_back({grey * kMeanColorScale, 128 * kMeanColorScale, 128 * kMeanColorScale});
  }
  return analysis;
}

RefinedView Start(const ViewAnalysis& analysis, float u) {
  return StartView(analysis.segments, std::vector<SlantedPlane>(4, SlantedPlane{0.5F, 0, u}));
}

TEST(KeepUnchanged, TakesOverTheDepthOfEachPixelNotOfTheSegment) {
  const ViewAnalysis segments = Columns({10, 20, 30, 40});
  RefinedView before = Start(segments, 7);
  before.planes[1] = {0, 0, 3};
  before.plane_of_pixel(2, 1) = 1;  // chosen at a jump
  RefinedView view = Start(segments, 1);
  KeepUnchanged(segments, {&segments, &before}, {&segments, &before}, 3, 1, view);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) EXPECT_EQ(view.At(x, y), before.At(x, y)) << x << "," << y;
  EXPECT_EQ(view.kept, (std::vector<std::uint8_t>{1, 1, 1, 1}));
  EXPECT_EQ(view.planes[2], before.planes[2]);  // the one under the segment's centre
  EXPECT_EQ(view.planes.size(), 4U + 4U);       // each plane that is used is copied once
}

TEST(KeepUnchanged, ChangedSegmentsStartFromTheirOwnPlane) {
  const ViewAnalysis segments = Columns({10, 20, 30, 40});
  const ViewAnalysis changed = Columns({10, 99, 30, 40});
  const RefinedView before = Start(segments, 7);
  RefinedView view = Start(changed, 1);
  KeepUnchanged(changed, {&segments, &before}, {&segments, &before}, 3, 1, view);
  EXPECT_EQ(view.kept, (std::vector<std::uint8_t>{1, 0, 1, 1}));
  EXPECT_EQ(view.plane_of_pixel(1, 0), 1U);
  EXPECT_EQ(view.At(1, 0), 1.5);
  EXPECT_TRUE(view.IsFree(1));
  EXPECT_FALSE(view.IsFree(0));
  EXPECT_FALSE(view.IsFree(view.plane_of_pixel(0, 0)));
}

TEST(KeepUnchanged, PrefersTheIFrameThenThePreviousFrame) {  // III-E: T_I is the stricter
  const ViewAnalysis i_segments = Columns({10, 20, 30, 40});
  const ViewAnalysis segments = Columns({10, 22, 30, 60});
  const RefinedView of_i_frame = Start(i_segments, 7);
  const RefinedView of_previous = Start(segments, 9);
  RefinedView view = Start(segments, 1);
  KeepUnchanged(segments, {&segments, &of_previous}, {&i_segments, &of_i_frame}, 3, 1, view);
  EXPECT_EQ(view.At(0, 1), 7);
  EXPECT_EQ(view.At(1, 1), 9 + 0.5);
  EXPECT_EQ(view.At(2, 1), 7 + 1);
  EXPECT_EQ(view.At(3, 1), 9 + 1.5);
}

// A segment over columns 0 to 2 whose columns 1 and 2 had the depth of something at u = 20.
struct NearerBefore {
  ViewAnalysis before;
  ViewAnalysis now = Columns({10, 10, 10, 80});
  RefinedView refined;
  RefinedView view;

  explicit NearerBefore(const std::vector<int>& greys) : before(Columns(greys)), refined(Start(before, 7)) {
    refined.planes[1] = refined.planes[2] = {0, 0, 20};
    for (int y = 0; y < 2; ++y)
      for (const int x : {1, 2}) now.segments.labels(x, y) = 0;
    view = Start(now, 1);
    KeepUnchanged(now, {&before, &refined}, {&before, &refined}, 3, 1, view);
  }
};

TEST(KeepUnchanged, PixelsThatAnObjectUncoveredHaveTheirSegmentsPlane) {
  const NearerBefore scene({10, 80, 80, 40});
  EXPECT_EQ(scene.view.kept[0], 1);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) EXPECT_EQ(scene.view.At(x, y), 7 + 0.5 * x) << x << "," << y;
}

TEST(KeepUnchanged, ADepthEdgeInsideASegmentStaysWhereNothingMoved) {  // noise is no motion
  const NearerBefore scene({10, 12, 8, 80});
  for (int y = 0; y < 2; ++y) {
    EXPECT_EQ(scene.view.At(0, y), 7);
    EXPECT_EQ(scene.view.At(1, y), 20);
    EXPECT_EQ(scene.view.At(2, y), 20);
  }
}

TEST(KeepUnchanged, StaysTheSameOverManyFramesAndDoesNotGrow) {
  const ViewAnalysis segments = Columns({10, 20, 30, 40});
  const RefinedView first = Start(segments, 7);
  RefinedView last = first;
  for (int frame = 0; frame < 20; ++frame) {
    RefinedView view = Start(segments, 1);
    KeepUnchanged(segments, {&segments, &last}, {&segments, &first}, 3, 0, view);
    last = view;
    EXPECT_LE(last.planes.size(), 8U);
  }
  EXPECT_EQ(last.Map(), first.Map());
}

TEST(StartFromAround, TakesThePlaneOfTheMostAlikeColourOnItsLevel) {
  const ViewAnalysis before = Columns({10, 20, 30, 40});
  RefinedView refined = Start(before, 7);
  refined.planes = {{0.25F, 0, 5}, {0, 0, 5.5F}, {0, 0, 9}, {0, 0, 4}};
  const ViewAnalysis now = Columns({31, 31, 31, 31});
  RefinedView view = StartView(now.segments, std::vector<SlantedPlane>(4, SlantedPlane{0, 0, 5}));
  view.kept[3] = 1;
  StartFromAround(now.segments, {&before, &refined}, std::vector<double>(4, 0.9), view);
  // All that is 4 or 8 pixels away is outside the picture; each sees what was at its own place.
  EXPECT_EQ(view.planes[0], refined.planes[0]);
  EXPECT_EQ(view.planes[1], refined.planes[1]);
  EXPECT_EQ(view.planes[2], (SlantedPlane{0, 0, 5}));  // 9 is another level
  EXPECT_EQ(view.planes[3], (SlantedPlane{0, 0, 5}));  // kept
}

TEST(StartFromAround, FollowsASurfaceThatMoved) {
  ViewAnalysis before{.picture = YcbcrImage(16, 1), .segments = {}};
  before.segments.labels = Grid<SegmentIndex>(16, 1);
  for (int x = 8; x < 16; ++x) before.segments.labels(x, 0) = 1;
  before.segments.centers = {{4, 0}, {12, 0}};
  before.segments.means = {{10 * kMeanColorScale, 0, 0}, {90 * kMeanColorScale, 0, 0}};
  RefinedView refined = StartView(before.segments, std::vector<SlantedPlane>{{0, 0, 2}, {0.01F, 0, 2}});
  ViewAnalysis now = before;
  now.segments.means[0] = before.segments.means[1];  // what was right of it
  RefinedView view = StartView(now.segments, std::vector<SlantedPlane>(2, SlantedPlane{0, 0, 2.2F}));
  StartFromAround(now.segments, {&before, &refined}, std::vector<double>(2, 0.5), view);
  EXPECT_EQ(view.planes[0], refined.planes[1]);
  EXPECT_EQ(view.planes[1], refined.planes[1]);
}

}  // namespace
}  // namespace depthfarm
