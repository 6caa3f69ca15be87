#include <gtest/gtest.h>

#include "worker/cost/energy_units.h"
#include "worker/cost/matching.h"
#include "worker/cost/smoothness.h"

namespace depthfarm {
namespace {

Camera TestCamera(double x) {
  Camera camera;
  camera.name = "cam";
  camera.width = 64;
  camera.height = 48;
  camera.intrinsics << 100, 0, 31.5, 0, 100, 23.5, 0, 0, 1;
  camera.cam_from_world_translation = Eigen::Vector3d(-x, 0, 0);
  return camera;
}

YcbcrImage Ramp(int width, int height) {
  YcbcrImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) picture(x, y).y = static_cast<std::uint8_t>(2 * x + 3 * y);
  }
  return picture;
}

MeanColor Grey(int y) { return {y * kMeanColorScale, 128 * kMeanColorScale, 128 * kMeanColorScale}; }

TEST(Smoothness, IsInitialSmoothingOverTheColourDistance) {  // eq. (3), L = 250: one grey level of cost is 1152 units
  const SmoothnessCost cost(1.0, 250);
  EXPECT_EQ(cost.Beta(Grey(10), Grey(14)), 1152 / 4);
  EXPECT_EQ(cost.Beta(Grey(14), Grey(10)), 1152 / 4);
  EXPECT_EQ(SmoothnessCost(4.0, 250).Beta(Grey(10), Grey(14)), 1152);
}

TEST(Smoothness, AMaskIsAComponentOfItsOwn) {
  MeanColor masked = Grey(10);
  masked.matte = 4 * kMeanColorScale;
  EXPECT_EQ(SmoothnessCost(1.0, 250).Beta(Grey(10), masked), 1152 / 4);
}

TEST(Matching, MasksAreNotComparedBetweenViews) {
  YcbcrImage masked = Ramp(64, 48);
  for (Ycbcr& pixel : masked.values()) pixel.matte = kForegroundMatte;
  EXPECT_EQ(WindowColorDifference(Ramp(64, 48), masked, {20, 20}, {20, 20}, 3).sum, 0);
}

TEST(Smoothness, FloorsTheDistanceAtOneGreyLevel) {
  const SmoothnessCost cost(1.0, 250);
  EXPECT_EQ(cost.Beta(Grey(10), Grey(10)), 1152);
  EXPECT_EQ(cost.Beta(Grey(10), Grey(11)), 1152);
}

TEST(Smoothness, CountsDifferencesInSharesOfTheRange) {  // the whole range costs the same for 50 and for 250 levels
  const std::int64_t fine = SmoothnessCost(1.0, 250).Beta(Grey(0), Grey(2)) * std::int64_t{249};
  const std::int64_t coarse = SmoothnessCost(1.0, 50).Beta(Grey(0), Grey(2)) * std::int64_t{49};
  EXPECT_NEAR(static_cast<double>(coarse) / static_cast<double>(fine), 1.0, 0.001);
}

TEST(Smoothness, IsEvenAndPositiveForTheMostDifferentColours) {
  const SmoothnessCost cost(0.01, 1000);
  const std::int32_t beta = cost.Beta({0, 0, 0}, {255 * 64, 255 * 64, 255 * 64});
  EXPECT_EQ(beta, 2);
  EXPECT_EQ(SmoothnessCost(0, 250).Beta(Grey(0), Grey(0)), 0);
}

TEST(WindowColorDifference, IsTheSumOfL1DistancesOverTheWindow) {  // eq. (4)
  YcbcrImage a(9, 9);
  YcbcrImage b(9, 9);
  b(4, 4) = {10, 130, 125, 0};
  b(5, 5) = {1, 128, 128, 0};
  const WindowDifference difference = WindowColorDifference(a, b, {4, 4}, {4, 4}, 3);
  EXPECT_EQ(difference.samples, 9);
  EXPECT_EQ(difference.sum, 10 + 2 + 3 + 1);
  EXPECT_EQ(WindowColorDifference(a, b, {4, 4}, {4, 4}, 1).sum, 15);
}

TEST(WindowColorDifference, ShiftedRampsDifferBySlopeTimesShift) {
  const YcbcrImage ramp = Ramp(20, 10);
  const WindowDifference difference = WindowColorDifference(ramp, ramp, {8, 5}, {11, 5}, 5);
  EXPECT_EQ(difference.samples, 25);
  EXPECT_EQ(difference.sum, 25 * 6);
}

TEST(WindowColorDifference, LeavesOutSamplesOutsideEitherPicture) {
  const YcbcrImage ramp = Ramp(20, 10);
  EXPECT_EQ(WindowColorDifference(ramp, ramp, {0, 0}, {0, 0}, 3).samples, 4);
  EXPECT_EQ(WindowColorDifference(ramp, ramp, {5, 5}, {19, 9}, 3).samples, 4);
  EXPECT_EQ(WindowColorDifference(ramp, ramp, {0, 5}, {19, 5}, 3).samples, 3);
}

TEST(MatchReward, IsKLessTheMeanAndNeverNegative) {  // eq. (5)
  const std::int32_t k = MatchOffsetSteps(30);
  EXPECT_EQ(k, 270);
  EXPECT_EQ(MatchReward({0, 9}, k), 270);
  EXPECT_EQ(MatchReward({90, 9}, k), 180);
  EXPECT_EQ(MatchReward({269, 9}, k), 1);
  EXPECT_EQ(MatchReward({270, 9}, k), 0);
  EXPECT_EQ(MatchReward({9000, 9}, k), 0);
}

TEST(MatchGeometry, PointsAppearAtTheirDisparity) {  // parallel pair: x' = x - f b / z
  const Camera left = TestCamera(0);
  const Camera right = TestCamera(0.5);
  const DepthLevels levels = DepthLevels::Create(left, 2.5, 10, 21).value();
  const MatchGeometry geometry(left, right, levels);
  EXPECT_EQ(geometry.Target({40, 20}, 0), (PixelPosition{40 - 5, 20}));
  EXPECT_EQ(geometry.Target({40, 20}, 20), (PixelPosition{40 - 20, 20}));
  EXPECT_EQ(geometry.Target({3, 20}, 0), std::nullopt);
}

TEST(MatchGeometry, FollowsTheEpipolarLineBeyondInfinity) {
  const Camera left = TestCamera(0);
  const DepthLevels levels = DepthLevels::Create(left, 2.5, 10, 21).value();
  const MatchGeometry geometry(left, TestCamera(0.5), levels);
  EXPECT_EQ(geometry.TargetOnPlane({40, 20}, 0.1), (PixelPosition{40 - 5, 20}));
  EXPECT_EQ(geometry.TargetOnPlane({40, 20}, 0), (PixelPosition{40, 20}));
  EXPECT_EQ(geometry.TargetOnPlane({40, 20}, -0.1), (PixelPosition{40 + 5, 20}));
  EXPECT_EQ(geometry.TargetOnPlane({40, 20}, -1), std::nullopt);  // outside the picture
}

TEST(MatchGeometry, GivesNoTargetForPlanesBehindACamera) {
  const Camera reference = TestCamera(0);
  Camera ahead = TestCamera(0.1);
  ahead.cam_from_world_translation[2] = -5;  // stands at z = 5
  const DepthLevels levels = DepthLevels::Create(reference, 2, 10, 9).value();
  const MatchGeometry geometry(reference, ahead, levels);
  EXPECT_NE(geometry.Target({31, 23}, 0), std::nullopt);
  EXPECT_EQ(geometry.Target({31, 23}, 8), std::nullopt);
  EXPECT_EQ(MatchGeometry(ahead, reference, levels).TargetOnPlane({31, 23}, 1 / 4.0), std::nullopt);
  EXPECT_NE(MatchGeometry(ahead, reference, levels).TargetOnPlane({31, 23}, 1 / 8.0), std::nullopt);
}

}  // namespace
}  // namespace depthfarm
