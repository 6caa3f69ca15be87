#include "worker/refinement/free_pixels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Segments 0, 1, 2 with planes of their own; plane 3 is of a reference frame.
RefinedView View(std::vector<std::uint8_t> kept, const std::vector<std::vector<PlaneIndex>>& rows) {
  RefinedView view{.planes = {{0, 0, 1}, {1, 0, 2}, {0, 1, 3}, {0, 0, 9}},
                   .kept = std::move(kept),
                   .plane_of_pixel = {static_cast<int>(rows[0].size()), static_cast<int>(rows.size())}};
  for (std::size_t y = 0; y < rows.size(); ++y)
    std::copy(rows[y].begin(), rows[y].end(), view.plane_of_pixel.row(static_cast<int>(y)));
  return view;
}

std::vector<PixelRun> Row(const FreePixels& free, int y) { return {free.Row(y).begin(), free.Row(y).end()}; }

TEST(FreePixels, AreRunsOfThePlanesOfSegmentsThatAreNotKept) {
  const FreePixels free(View({0, 1, 0}, {{0, 2, 1, 3, 0}, {1, 1, 3, 3, 1}, {2, 2, 0, 0, 0}, {3, 3, 2, 2, 1}}));
  EXPECT_THAT(Row(free, 0), ElementsAre(PixelRun{0, 2}, PixelRun{4, 5}));
  EXPECT_THAT(Row(free, 1), IsEmpty());
  EXPECT_THAT(Row(free, 2), ElementsAre(PixelRun{0, 5}));
  EXPECT_THAT(Row(free, 3), ElementsAre(PixelRun{2, 4}));
  EXPECT_EQ(free.num_segments(), 2);
  EXPECT_EQ(free.NumberOf(0), 0);
  EXPECT_EQ(free.NumberOf(2), 1);
}

TEST(FreePixels, AreAllOfAnIFrame) {
  RefinedView view = View({0, 0, 0}, {{0, 1, 2}, {2, 1, 0}});
  view.planes.pop_back();
  const FreePixels free(view);
  for (int y = 0; y < 2; ++y) EXPECT_THAT(Row(free, y), ElementsAre(PixelRun{0, 3}));
  EXPECT_EQ(free.num_segments(), 3);
}

TEST(UpdateMap, MakesTheMapOfAViewWhosePlanesHaveMoved) {
  RefinedView view = View({0, 1, 0}, {{0, 2, 1, 3, 0}, {2, 1, 3, 1, 0}});
  InverseDepthMap map = view.Map();
  view.planes[0] = {0.5F, 0.25F, 4};
  view.planes[2].c = -1;
  EXPECT_NE(map, view.Map());
  UpdateMap(view, FreePixels(view), map);
  EXPECT_EQ(map, view.Map());
}

}  // namespace
}  // namespace depthfarm
