#include "common/quality/stability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;

class StabilityTest : public testing::Test {
 protected:
  // The depth map of the level plane `level`, in the reference camera itself.
  [[nodiscard]] DepthMap PlaneAt(double level) const {
    const double nearness = 1.0 / 10 + level / 90 * (1.0 / 2 - 1.0 / 10);
    return DepthMap(kWidth, kHeight, static_cast<float>(1 / nearness));
  }

  Camera camera_ = ForwardCamera("ref", 0, 0, kWidth, kHeight, 50);
  DepthLevels levels_ = *DepthLevels::Create(camera_, 2, 10, 91);
};

TEST_F(StabilityTest, CountsChangesBeyondOneLevel) {
  DepthMap now = PlaneAt(40);
  for (int x = 0; x < kWidth; ++x) now(x, 3) = PlaneAt(43)(0, 0);
  for (int x = 0; x < kWidth; ++x) now(x, 4) = PlaneAt(41)(0, 0);
  const PixelMask all(kWidth, kHeight, 1);
  const StabilityFigures figures = MeasureStability(PlaneAt(40), {&now, camera_}, all, levels_);
  EXPECT_EQ(figures.still, kWidth * kHeight);
  EXPECT_EQ(figures.changed, kWidth);
  EXPECT_NEAR(figures.MeanLevelDifference(), 4.0 / kHeight, 1e-4);
}

TEST_F(StabilityTest, PixelsThatMovedOrHaveNoDepthDoNotCount) {
  DepthMap now = PlaneAt(80);
  now(0, 0) = 0;
  PixelMask still(kWidth, kHeight, 0);
  still(0, 0) = 1;
  const StabilityFigures figures = MeasureStability(PlaneAt(40), {&now, camera_}, still, levels_);
  EXPECT_EQ(figures.still, 0);
  EXPECT_TRUE(std::isnan(figures.ChangedPercent()));
}

TEST_F(StabilityTest, FramesAddUp) {
  const DepthMap now = PlaneAt(45);
  const PixelMask all(kWidth, kHeight, 1);
  StabilityFigures sum = MeasureStability(PlaneAt(40), {&now, camera_}, all, levels_);
  sum.Add(MeasureStability(PlaneAt(45), {&now, camera_}, all, levels_));
  EXPECT_DOUBLE_EQ(sum.ChangedPercent(), 50);
  EXPECT_NEAR(sum.MeanLevelDifference(), 2.5, 1e-4);
}

TEST(StillPixels, NoiseIsStillAndAMovedObjectIsNot) {
  const YcbcrImage before(40, 30, Ycbcr{100, 128, 128, 0});
  YcbcrImage now = before;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) now(x, y).y = static_cast<std::uint8_t>((x + y) % 2 == 0 ? 104 : 96);
  }
  for (int y = 10; y < 20; ++y) {
    for (int x = 30; x < 40; ++x) now(x, y).y = 160;
  }
  const PixelMask still = StillPixels(before, now);
  EXPECT_EQ(still(5, 5), 1);
  EXPECT_EQ(still(20, 15), 1);
  EXPECT_EQ(still(35, 15), 0);
  EXPECT_EQ(still(28, 15), 0) << "the window reaches into what moved";
  EXPECT_EQ(still(0, 0), 1);
}

}  // namespace
}  // namespace depthfarm
