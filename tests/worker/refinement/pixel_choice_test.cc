#include "worker/refinement/pixel_choice.h"

#include <gtest/gtest.h>

#include <stop_token>

#include "tests/worker/refinement/two_views.h"

namespace depthfarm {
namespace {

constexpr int kEdge = 20;  // a board at u = 8 ends here, the wall behind is at u = 2
constexpr double kNear = 8;
constexpr double kFar = 2;

// The board left of the edge is dark, the wall bright; the segments' border is three pixels too far right.
struct Edge {
  TwoViews views{kFar};
  Grid<SegmentIndex> segments{TwoViews::kWidth, TwoViews::kHeight};
  RefinedView refined{.planes = {{0, 0, float(kNear)}, {0, 0, float(kFar)}}, .kept = {0, 0}, .plane_of_pixel = {}};

  Edge() {
    const auto dark = [](Ycbcr pixel) {
      pixel.y = static_cast<std::uint8_t>(std::max(0, pixel.y - 40));
      return pixel;
    };
    for (int y = 0; y < TwoViews::kHeight; ++y) {
      for (int x = 0; x < TwoViews::kWidth; ++x) {
        if (x < kEdge) views.own(x, y) = dark(TextureAt(x, y));
        segments(x, y) = x < kEdge + 3 ? 0 : 1;
        if (x >= kEdge - int(kNear)) continue;
        views.there(x, y) = dark(TextureAt(x + kNear, y));
        views.there_map(x, y) = float(kNear);
      }
    }
    refined.plane_of_pixel = segments;
  }

  void Choose(const std::stop_token& stop = {}) {
    const std::vector<OtherView> others{views.Other()};
    ChoosePlanes(views.own, segments, refined.Map(), others, nullptr, refined, stop);
  }
};

TEST(ChoosePlanes, MovesTheDepthEdgeToThePictures) {
  Edge edge;
  edge.Choose();
  for (int y = 1; y + 1 < TwoViews::kHeight; ++y) {
    for (int x = 12; x < TwoViews::kWidth - 6; ++x)
      EXPECT_EQ(edge.refined.At(x, y), x < kEdge ? kNear : kFar) << x << "," << y;
  }
}

// A dark rod in front of the wall, from top to bottom of both views; of its segments only the highest has its depth.
TEST(ChoosePlanes, APlaneSpreadsAlongARodThatOtherSegmentsMissed) {
  constexpr int kLeft = 20;
  constexpr int kWidth = 2;
  constexpr int kFound = 5;  // rows
  TwoViews views(kFar);
  const auto on_rod = [](int x, int left) { return x >= left && x < left + kWidth; };
  RefinedView refined{.planes = {{0, 0, float(kFar)}, {0, 0, float(kNear)}}, .kept = {0, 0}, .plane_of_pixel = {}};
  Grid<SegmentIndex> segments(TwoViews::kWidth, TwoViews::kHeight);
  for (int y = 0; y < TwoViews::kHeight; ++y) {
    for (int x = 0; x < TwoViews::kWidth; ++x) {
      if (on_rod(x, kLeft)) views.own(x, y) = {20, 100, 128, 0};
      if (on_rod(x, kLeft - int(kNear))) {
        views.there(x, y) = {20, 100, 128, 0};
        views.there_map(x, y) = float(kNear);
      }
      segments(x, y) = on_rod(x, kLeft) && y < kFound ? 1 : 0;
    }
  }
  refined.plane_of_pixel = segments;
  const std::vector<OtherView> others{views.Other()};
  ChoosePlanes(views.own, segments, refined.Map(), others, nullptr, refined);
  for (int y = 0; y < TwoViews::kHeight; ++y) {
    for (int x = 15; x < 30; ++x) ASSERT_EQ(refined.At(x, y), on_rod(x, kLeft) ? kNear : kFar) << x << "," << y;
  }
}

TEST(ChoosePlanes, PixelsOfKeptSegmentsStay) {
  Edge edge;
  edge.refined.kept[0] = 1;
  const Grid<PlaneIndex> before = edge.refined.plane_of_pixel;
  edge.Choose();
  for (int y = 0; y < TwoViews::kHeight; ++y)
    for (int x = 0; x < kEdge + 3; ++x) ASSERT_EQ(edge.refined.plane_of_pixel(x, y), before(x, y));
}

TEST(ChoosePlanes, EndsEarlyWhenAskedTo) {
  Edge edge;
  std::stop_source stop;
  stop.request_stop();
  edge.Choose(stop.get_token());
  EXPECT_EQ(edge.refined.plane_of_pixel, edge.segments);
}

TEST(ChoosePlanes, LeavesASmoothSurfaceAlone) {
  Edge edge;
  edge.refined.planes[0] = {0, 0, 2.3F};
  edge.Choose();
  EXPECT_EQ(edge.refined.plane_of_pixel, edge.segments);
}

}  // namespace
}  // namespace depthfarm
