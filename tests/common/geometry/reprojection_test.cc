#include "common/geometry/reprojection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/common/geometry/plain_geometry.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

TEST(Reprojection, GoesWhereTheWorldPointIsSeen) {  // eq. (4)
  std::mt19937_64 random(1);
  int in_front = 0;
  for (int i = 0; i < 500; ++i) {
    const Camera source = AnyCamera(random, "source", std::numbers::pi, 5);
    const Camera target = AnyCamera(random, "target", std::numbers::pi, 5);
    const double x = Uniform(random, -0.5, 23.5);
    const double y = Uniform(random, -0.5, 15.5);
    const double z = Uniform(random, 0.5, 40);
    const Eigen::Vector3d point = PointAt(source, x, y, z);
    const double z_in_target = PointInCamera(target, point).z();
    const Reprojection::Projected p = Reprojection(source, target).Project(x, y, 1 / z);
    EXPECT_NEAR(p.depth_per_source, z_in_target / z, 1e-11);
    EXPECT_EQ(p.depth_per_source > 0, z_in_target > 0);
    if (z_in_target < 0.1) continue;
    ++in_front;
    const Eigen::Vector2d pixel = PixelOf(target, point);
    EXPECT_NEAR(p.x, pixel.x(), 1e-7 * (1 + std::abs(pixel.x())));
    EXPECT_NEAR(p.y, pixel.y(), 1e-7 * (1 + std::abs(pixel.y())));
  }
  EXPECT_GT(in_front, 100);
  EXPECT_LT(in_front, 400);
}

TEST(Reprojection, ToTheCameraItselfChangesNothing) {
  std::mt19937_64 random(2);
  const Camera camera = AnyCamera(random, "camera", std::numbers::pi, 5);
  const Reprojection::Projected p = Reprojection(camera, camera).Project(3, 12, 0.25);
  EXPECT_NEAR(p.x, 3, 1e-12);
  EXPECT_NEAR(p.y, 12, 1e-12);
  EXPECT_NEAR(p.depth_per_source, 1, 1e-12);
}

TEST(Reprojection, BetweenParallelViewsIsTheDisparity) {
  const Camera left = ForwardCamera("left", 0, 0, 320, 240, 300);
  const Camera right = ForwardCamera("right", 0.5, 0, 320, 240, 300);
  const Reprojection::Projected p = Reprojection(left, right).Project(100, 50, 1.0 / 6);
  EXPECT_NEAR(p.x, 100 - 300 * 0.5 / 6, 1e-12);
  EXPECT_NEAR(p.y, 50, 1e-12);
  EXPECT_NEAR(p.depth_per_source, 1, 1e-15);
}

TEST(Reprojection, AtInfinityOnlyTheRotationCounts) {
  std::mt19937_64 random(3);
  const Camera source = AnyCamera(random, "source", 0.3, 5);
  Camera target = AnyCamera(random, "target", 0.3, 5);
  const Reprojection::Projected here = Reprojection(source, target).Project(5, 6, 0);
  target.cam_from_world_translation += Eigen::Vector3d(7, -3, 2);
  const Reprojection::Projected there = Reprojection(source, target).Project(5, 6, 0);
  EXPECT_DOUBLE_EQ(here.x, there.x);
  EXPECT_DOUBLE_EQ(here.y, there.y);
}

}  // namespace
}  // namespace depthfarm
