#include "common/quality/depth_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/quality/visibility.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;

// Views in a row, levels seen from the middle one; a level is 100 * 0.5 * (1/4 - 1/20) / 50 = 0.2 px.
class DepthErrorTest : public testing::Test {
 protected:
  Camera left_ = ForwardCamera("left", -0.5, 0, kWidth, kHeight, 100);
  Camera middle_ = ForwardCamera("middle", 0, 0, kWidth, kHeight, 100);
  DepthLevels levels_ = DepthLevels::Create(middle_, 4, 20, 51).value();

  [[nodiscard]] DepthMap PlaneAt(double level) const {
    const double inverse = 1.0 / 20 + (1.0 / 4 - 1.0 / 20) * level / 50;
    return DepthMap(kWidth, kHeight, static_cast<float>(1.0 / inverse));
  }

  [[nodiscard]] std::vector<DepthErrorGroup> Measure(const DepthMap& estimated, const DepthMap& exact,
                                                     const ZoneMap* zones = nullptr) const {
    DepthErrorInput input;
    input.estimated = &estimated;
    input.exact = &exact;
    input.camera = left_;
    input.levels = &levels_;
    input.neighbour = middle_;
    input.zones = zones;
    input.zone_names = {"unknown", "textured", "slanted"};
    Result<std::vector<DepthErrorGroup>> groups = MeasureDepthError(input);
    EXPECT_TRUE(groups.ok()) << groups.status().message();
    return std::move(groups).value();
  }
};

const DepthErrorFigures& Group(const std::vector<DepthErrorGroup>& groups, const std::string& name) {
  for (const DepthErrorGroup& group : groups) {
    if (group.name == name) return group.figures;
  }
  ADD_FAILURE() << "no group " << name;
  return groups.front().figures;
}

TEST_F(DepthErrorTest, LevelIndexGivesTheLevelsBack) {
  for (int level = 0; level < 51; ++level) EXPECT_NEAR(LevelIndex(levels_, levels_.DepthInRef(level)), level, 1e-9);
}

TEST_F(DepthErrorTest, APlaneShiftedByThreeLevelsIsOffByThree) {
  const DepthErrorFigures all = Group(Measure(PlaneAt(23), PlaneAt(20)), "all");
  EXPECT_EQ(all.pixels, kWidth * kHeight);
  EXPECT_NEAR(all.MeanLevels(), 3, 1e-4);
  EXPECT_NEAR(all.RmseLevels(), 3, 1e-4);
  EXPECT_NEAR(all.MeanPx(), 0.6, 1e-4);
  EXPECT_NEAR(all.RmsePx(), 0.6, 1e-4);
  for (const std::size_t half_one_and_two : {0, 1, 2}) {
    EXPECT_DOUBLE_EQ(all.BadLevelsPercent(half_one_and_two), 100);
  }
  EXPECT_DOUBLE_EQ(all.BadLevelsPercent(3), 0);
  EXPECT_DOUBLE_EQ(all.BadPxPercent(0), 100);
  EXPECT_DOUBLE_EQ(all.BadPxPercent(1), 0);
  EXPECT_DOUBLE_EQ(all.CompletenessPercent(), 100);
}

TEST_F(DepthErrorTest, AMissingEstimateIsBadAndLowersCompleteness) {
  DepthMap estimated = PlaneAt(20);
  for (int y = 0; y < kHeight / 2; ++y) {
    for (int x = 0; x < kWidth; ++x) estimated(x, y) = 0;
  }
  const DepthErrorFigures all = Group(Measure(estimated, PlaneAt(20)), "all");
  EXPECT_DOUBLE_EQ(all.BadLevelsPercent(3), 50);
  EXPECT_DOUBLE_EQ(all.BadPxPercent(3), 50);
  EXPECT_DOUBLE_EQ(all.CompletenessPercent(), 50);
  EXPECT_NEAR(all.MeanPx(), 0, 1e-9);
}

TEST_F(DepthErrorTest, PixelsWithoutTruthDoNotCount) {
  DepthMap exact = PlaneAt(20);
  exact(5, 5) = 0;
  EXPECT_EQ(Group(Measure(PlaneAt(23), exact), "all").pixels, kWidth * kHeight - 1);
}

TEST_F(DepthErrorTest, ZonesPartTheError) {
  ZoneMap zones(kWidth, kHeight, 1);
  DepthMap estimated = PlaneAt(20);
  const DepthMap shifted = PlaneAt(25);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < 20; ++x) {
      zones(x, y) = 2;
      estimated(x, y) = shifted(x, y);
    }
  }
  const std::vector<DepthErrorGroup> groups = Measure(estimated, PlaneAt(20), &zones);
  EXPECT_NEAR(Group(groups, "slanted").MeanLevels(), 5, 1e-4);
  EXPECT_EQ(Group(groups, "slanted").pixels, 20 * kHeight);
  EXPECT_NEAR(Group(groups, "textured").MeanLevels(), 0, 1e-4);
  for (const DepthErrorGroup& group : groups) EXPECT_NE(group.name, "unknown");
}

TEST_F(DepthErrorTest, EdgesReachFourPixels) {
  DepthMap exact = PlaneAt(10);
  const DepthMap front = PlaneAt(20);  // 2 px
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 40; x < kWidth; ++x) exact(x, y) = front(x, y);
  }
  const PixelMask edges = DepthEdges(exact, left_, middle_);
  for (int x = 0; x < kWidth; ++x) EXPECT_EQ(edges(x, 30), x >= 35 && x <= 44 ? 1 : 0) << x;
  EXPECT_EQ(Group(Measure(exact, exact), "edge").pixels, 10 * kHeight);
  EXPECT_EQ(Group(Measure(exact, exact), "border").pixels, kWidth * kHeight - (kWidth - 16) * (kHeight - 16));
}

TEST_F(DepthErrorTest, OccludedPixelsLeaveTheNonOccludedGroup) {
  const std::vector<TexturedPlane> planes = {{.point = {0, 0, 16}}, {.point = {0, 0, 5}, .min_x = -0.5, .max_x = 0.5}};
  const PlaneView left = RenderPlanes(left_, planes);
  const PlaneView middle = RenderPlanes(middle_, planes);
  const PixelMask visible = VisibleInAny({&left.depth, left_}, {{&middle.depth, middle_}}, levels_);
  int occluded = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // Background at x in `left` appears at x - 3.125 in `middle`, the front there covers 29.5 .. 49.5.
      const double there = x - 100 * 0.5 / 16;
      const bool front = left.depth(x, y) < 10;
      const bool inside = front || there >= -0.5;
      const bool hidden = !front && there > 31 && there < 48;
      if (hidden) {
        ++occluded;
        EXPECT_EQ(visible(x, y), 0) << x << "," << y;
      } else if (inside && (front || there < 28 || there > 51)) {
        EXPECT_EQ(visible(x, y), 1) << x << "," << y;
      } else if (!inside) {
        EXPECT_EQ(visible(x, y), 0) << x << "," << y;
      }
    }
  }
  EXPECT_GT(occluded, 0);
}

TEST_F(DepthErrorTest, SumsOfFramesAreSumsOfPixels) {
  std::vector<DepthErrorGroup> sum;
  AddGroups(Measure(PlaneAt(20), PlaneAt(20)), sum);
  AddGroups(Measure(PlaneAt(24), PlaneAt(20)), sum);
  EXPECT_NEAR(Group(sum, "all").MeanLevels(), 2, 1e-4);
  EXPECT_NEAR(Group(sum, "all").RmseLevels(), std::sqrt(8.0), 1e-4);
}

TEST_F(DepthErrorTest, RefusesAnotherSize) {
  const DepthMap exact = PlaneAt(20);
  const DepthMap estimated(10, 20, 5.0F);
  DepthErrorInput input;
  input.estimated = &estimated;
  input.exact = &exact;
  input.camera = left_;
  input.levels = &levels_;
  input.neighbour = middle_;
  const Result<std::vector<DepthErrorGroup>> groups = MeasureDepthError(input);
  ASSERT_FALSE(groups.ok());
  EXPECT_NE(groups.status().message().find("10x20"), std::string::npos);
}

}  // namespace
}  // namespace depthfarm
