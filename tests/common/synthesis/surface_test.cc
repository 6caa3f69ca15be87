#include "common/synthesis/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

TEST(Surface, ASteeplySlantedPlaneIsNotTorn) {
  const Camera source = ForwardCamera("a", 0, 0, 80, 60, 100);
  const Camera target = ForwardCamera("b", 1, 0, 80, 60, 100);
  DepthMap depth(80, 60);
  for (int y = 0; y < 60; ++y) {
    // 1/z grows by 2 px of disparity per pixel: twice the step that would tear it if it stood alone.
    for (int x = 0; x < 80; ++x) depth(x, y) = 1.0F / (0.05F + 0.02F * static_cast<float>(x));
  }
  const Surface surface = ProjectSurface(depth, source, target);
  for (int y = 0; y < 58; ++y) {
    for (int x = 2; x < 77; ++x) {
      ASSERT_EQ(surface.flags(x, y) & (Surface::kTornRight | Surface::kTornBelow), 0) << x << "," << y;
    }
  }
}

TEST(Surface, AJumpTearsAndMarksItsFarSide) {
  const Camera source = ForwardCamera("a", 0, 0, 40, 20, 100);
  const Camera target = ForwardCamera("b", 1, 0, 40, 20, 100);
  DepthMap depth(40, 20, 10.0F);
  for (int y = 0; y < 20; ++y) {
    for (int x = 20; x < 40; ++x) depth(x, y) = 5.0F;
  }
  const Surface surface = ProjectSurface(depth, source, target);
  EXPECT_NE(surface.flags(19, 10) & Surface::kTornRight, 0);
  EXPECT_NE(surface.flags(19, 10) & Surface::kBehindEdge, 0);
  EXPECT_EQ(surface.flags(20, 10) & Surface::kBehindEdge, 0);
  EXPECT_EQ(surface.flags(18, 10) & (Surface::kTornRight | Surface::kTornBelow), 0);
  EXPECT_NE(surface.flags(10, 10) & Surface::kSmooth, 0);
  EXPECT_EQ(surface.flags(18, 10) & Surface::kSmooth, 0);
}

TEST(RenderInverseDepth, CoversAStretchedPlaneWithoutCracks) {
  const Camera source = ForwardCamera("a", 0, 0, 80, 60, 100);
  // The target sees everything 2.3 times larger and between pixels.
  const Camera target = ForwardCamera("b", 0.013, 0.007, 160, 120, 230);
  const PlaneView view = RenderPlanes(source, {{.point = {0, 0, 4}, .normal = {0.3, 0.2, 1}}});
  const Grid<float> inverse = RenderInverseDepth(ProjectSurface(view.depth, source, target), 160, 120);
  const PlaneView exact = RenderPlanes(target, {{.point = {0, 0, 4}, .normal = {0.3, 0.2, 1}}});
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      ASSERT_GT(inverse(x, y), 0) << x << "," << y;
      EXPECT_NEAR(inverse(x, y) * exact.depth(x, y), 1, 1e-4) << x << "," << y;
    }
  }
}

TEST(RenderInverseDepth, TheNearerSurfaceWins) {
  const Camera source = ForwardCamera("a", 0, 0, 60, 20, 100);
  const Camera target = ForwardCamera("b", 0.5, 0, 60, 20, 100);
  DepthMap depth(60, 20, 10.0F);
  for (int y = 0; y < 20; ++y) {
    for (int x = 30; x < 40; ++x) depth(x, y) = 5.0F;  // moves 10 px to the left, the background 5 px
  }
  const Grid<float> inverse = RenderInverseDepth(ProjectSurface(depth, source, target), 60, 20);
  for (int x = 0; x < 55; ++x) {
    // Pixels 20..29 are the front, 30..34 were hidden from the source.
    const float expected = x >= 20 && x < 30 ? 0.2F : x >= 30 && x < 35 ? 0.0F : 0.1F;
    EXPECT_FLOAT_EQ(inverse(x, 10), expected) << x;
  }
}

}  // namespace
}  // namespace depthfarm
