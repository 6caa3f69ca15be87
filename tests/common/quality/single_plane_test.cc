#include "common/quality/single_plane.h"

#include <gtest/gtest.h>

#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

TEST(SinglePlane, FindsThePlaneOfAFlatScene) {
  const std::vector<TexturedPlane> scene = {{.point = {0, 0, 8}, .frequency = 0.5}};
  const PlaneView left = RenderPlanes(ForwardCamera("a", -0.4, 0, 96, 72, 100), scene);
  const PlaneView middle = RenderPlanes(ForwardCamera("b", 0, 0, 96, 72, 100), scene);
  const PlaneView right = RenderPlanes(ForwardCamera("c", 0.4, 0, 96, 72, 100), scene);
  const DepthLevels levels = DepthLevels::Create(middle.camera, 4, 16, 100).value();
  const Result<SinglePlane> best = BestSinglePlane({{&left.picture, left.camera}, {&right.picture, right.camera}},
                                                   {&middle.picture, middle.camera}, levels);
  ASSERT_TRUE(best.ok()) << best.status().message();
  EXPECT_NEAR(1 / best->depth_in_ref, 1.0 / 8, (1.0 / 4 - 1.0 / 16) / 63);
  EXPECT_GT(PsnrFullRange(best->error), 40);
}

TEST(SinglePlane, IsWorseThanTheTruthForTwoPlanes) {
  const std::vector<TexturedPlane> scene = {{.point = {0, 0, 14}, .frequency = 0.5},
                                            {.point = {0, 0, 5}, .min_x = -0.5, .max_x = 0.5, .frequency = 0.8}};
  const PlaneView left = RenderPlanes(ForwardCamera("a", -0.4, 0, 96, 72, 100), scene);
  const PlaneView middle = RenderPlanes(ForwardCamera("b", 0, 0, 96, 72, 100), scene);
  const PlaneView right = RenderPlanes(ForwardCamera("c", 0.4, 0, 96, 72, 100), scene);
  const DepthLevels levels = DepthLevels::Create(middle.camera, 4, 16, 100).value();
  const Result<SinglePlane> best = BestSinglePlane({{&left.picture, left.camera}, {&right.picture, right.camera}},
                                                   {&middle.picture, middle.camera}, levels);
  ASSERT_TRUE(best.ok());
  EXPECT_LT(PsnrFullRange(best->error), 30);
  EXPECT_FALSE(BestSinglePlane({}, {&middle.picture, middle.camera}, levels).ok());
}

}  // namespace
}  // namespace depthfarm
