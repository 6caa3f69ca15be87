#include "common/quality/consistency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

class AgreementTest : public testing::Test {
 protected:
  Camera left_camera_ = ForwardCamera("left", -0.5, 0, 120, 90, 100);
  Camera right_camera_ = ForwardCamera("right", 0.5, 0, 120, 90, 100);
  DepthLevels levels_ = DepthLevels::Create(left_camera_, 4, 20, 51).value();
  std::vector<TexturedPlane> planes_ = {{.point = {0, 0, 16}, .normal = {0.4, 0.2, 1}},
                                        {.point = {0, 0, 6}, .min_x = -0.6, .max_x = 0.8}};
  PlaneView left_ = RenderPlanes(left_camera_, planes_);
  PlaneView right_ = RenderPlanes(right_camera_, planes_);
  ViewDepth left_exact_{&left_.depth, left_camera_};
  ViewDepth right_exact_{&right_.depth, right_camera_};

  [[nodiscard]] DepthMap Shifted(const DepthMap& depth, double levels) const {
    DepthMap result = depth;
    const double step = (1.0 / 4 - 1.0 / 20) / 50;
    for (float& z : result.values()) z = static_cast<float>(1.0 / (1.0 / static_cast<double>(z) + levels * step));
    return result;
  }
};

TEST_F(AgreementTest, ExactDepthAgreesWhereverItIsVisible) {
  const PixelMask visible = VisibleInAny(left_exact_, {right_exact_}, levels_);
  const AgreementFigures figures = MeasureAgreement(left_exact_, right_exact_, levels_, &visible);
  EXPECT_GT(figures.non_occluded, 120 * 90 / 2);
  EXPECT_GT(figures.in_view, figures.non_occluded);  // something is occluded in this scene
  EXPECT_LT(figures.InViewPercent(), 100);
  EXPECT_DOUBLE_EQ(figures.NonOccludedPercent(), 100);
  const AgreementFigures unaided = MeasureAgreement(left_exact_, right_exact_, levels_, nullptr);
  EXPECT_DOUBLE_EQ(unaided.NonOccludedPercent(), 100);
}

TEST_F(AgreementTest, ExactDepthOfOnePlaneAgreesEverywhere) {
  const std::vector<TexturedPlane> plane = {{.point = {0, 0, 16}, .normal = {0.4, 0.2, 1}}};
  const PlaneView left = RenderPlanes(left_camera_, plane);
  const PlaneView right = RenderPlanes(right_camera_, plane);
  const AgreementFigures figures =
      MeasureAgreement({&left.depth, left_camera_}, {&right.depth, right_camera_}, levels_, nullptr);
  EXPECT_DOUBLE_EQ(figures.InViewPercent(), 100);
  EXPECT_DOUBLE_EQ(figures.NonOccludedPercent(), 100);
  EXPECT_LT(figures.MeanLevelDifference(), 0.05);
}

TEST_F(AgreementTest, OneViewFarOffAgreesNowhere) {
  const PixelMask visible = VisibleInAny(left_exact_, {right_exact_}, levels_);
  const DepthMap off = Shifted(right_.depth, 5);
  const AgreementFigures figures = MeasureAgreement(left_exact_, {&off, right_camera_}, levels_, &visible);
  EXPECT_LT(figures.NonOccludedPercent(), 1);
  EXPECT_NEAR(figures.MeanLevelDifference(), 5, 0.5);
}

TEST_F(AgreementTest, MissingDepthIsNotJudged) {
  const DepthMap none(120, 90, 0.0F);
  const AgreementFigures figures = MeasureAgreement(left_exact_, {&none, right_camera_}, levels_, nullptr);
  EXPECT_EQ(figures.in_view, 0);
  EXPECT_TRUE(std::isnan(figures.InViewPercent()));
}

}  // namespace
}  // namespace depthfarm
