#include "common/scene/shape.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/scene/hash.h"

namespace depthfarm {
namespace {

using Eigen::Vector3d;

Shape Solid(Shape::Kind kind, const Vector3d& extent) {
  Shape shape;
  shape.kind = kind;
  shape.extent = extent;
  return shape;
}

std::vector<Shape> Solids() {
  return {Solid(Shape::Kind::kBox, {0.3, 0.5, 0.2}), Solid(Shape::Kind::kEllipsoid, {0.3, 0.5, 0.2}),
          Solid(Shape::Kind::kCylinder, {0.3, 0.5, 0.3}), Solid(Shape::Kind::kCapsule, {0.2, 0.4, 0.2})};
}

Vector3d RandomVector(int counter) {
  return {Uniform(5, 3 * counter, -1, 1), Uniform(5, 3 * counter + 1, -1, 1), Uniform(5, 3 * counter + 2, -1, 1)};
}

// How far outside the solid a point is, along one of the measures that are 0 on its surface.
double Outside(const Shape& shape, const Vector3d& p) {
  const Vector3d& e = shape.extent;
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return (p.cwiseAbs() - e).maxCoeff();
    case Shape::Kind::kEllipsoid:
      return p.cwiseQuotient(e).norm() - 1;
    case Shape::Kind::kCylinder:
      return std::max(std::hypot(p.x(), p.z()) - e.x(), std::abs(p.y()) - e.y());
    case Shape::Kind::kCapsule:
      return (p - Vector3d(0, std::clamp(p.y(), -e.y(), e.y()), 0)).norm() - e.x();
    case Shape::Kind::kPlane:
      break;
  }
  return -p.z();
}

TEST(SceneShape, RaysMeetSolidsAtKnownDistances) {
  const Vector3d from(0, 0, -2);
  const Vector3d ahead(0, 0, 1);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kPlane, Vector3d::Zero()), from, ahead), 2);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kBox, {1, 1, 0.5}), from, ahead), 1.5);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kEllipsoid, {1, 1, 0.25}), from, ahead), 1.75);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kCylinder, {0.5, 1, 0.5}), from, ahead), 1.5);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kCapsule, {0.5, 1, 0.5}), from, ahead), 1.5);
  // From above: the disc of the cylinder, the round end of the capsule.
  const Vector3d above(0.3, -3, 0);
  const Vector3d down(0, 1, 0);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kCylinder, {0.5, 1, 0.5}), above, down), 2);
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kCapsule, {0.5, 1, 0.5}), above, down), 1.6);
}

TEST(SceneShape, DistancesCountInLengthsOfTheDirection) {
  EXPECT_DOUBLE_EQ(FirstHit(Solid(Shape::Kind::kBox, {1, 1, 0.5}), {0, 0, -2}, {0, 0, 0.5}), 3);
}

TEST(SceneShape, SolidsBehindOrBesideARayAreNotMet) {
  for (const Shape& shape : Solids()) {
    EXPECT_EQ(FirstHit(shape, {0, 0, -2}, {0, 0, -1}), 0);
    EXPECT_EQ(FirstHit(shape, {0, 2, -2}, {0, 0, 1}), 0);
  }
}

TEST(SceneShape, EveryHitIsAnEntryThroughTheSurface) {
  for (const Shape& shape : Solids()) {
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector3d origin = 2.0 * RandomVector(2 * i).normalized();
      const Vector3d direction = 0.4 * RandomVector(2 * i + 1) - origin;
      const double t = FirstHit(shape, origin, direction);
      if (t == 0) {
        // A miss: no point of the ray is inside.
        for (int step = 1; step < 40; ++step) EXPECT_GT(Outside(shape, origin + step * 0.05 * direction), -1e-9);
        continue;
      }
      ++hits;
      const Vector3d point = origin + t * direction;
      EXPECT_NEAR(Outside(shape, point), 0, 1e-9);
      EXPECT_GT(Outside(shape, origin + 0.9 * t * direction), 0);
      const Vector3d normal = LocalNormal(shape, point);
      EXPECT_NEAR(normal.norm(), 1, 1e-9);
      EXPECT_LE(normal.dot(direction), 1e-9);
      EXPECT_LT(Outside(shape, point - 1e-4 * normal), 0);
    }
    EXPECT_GT(hits, 500);
  }
}

TEST(SceneShape, SmallestAlongBoundsAllSurfacePointsTightly) {
  for (Shape shape : Solids()) {
    shape.center = Vector3d(0.4, -0.3, 3);
    shape.local_from_world = TurnedBy(0.7);
    const Vector3d axis = Vector3d(0.2, 0.1, 0.9).normalized();
    const double bound = SmallestAlong(shape, axis);
    double smallest = 1e9;
    for (int i = 0; i < 20000; ++i) {
      const Vector3d origin = 2.0 * RandomVector(i).normalized();
      const double t = FirstHit(shape, origin, 0.6 * RandomVector(i + 20000) - origin);
      if (t == 0) continue;
      const Vector3d local = origin + t * (0.6 * RandomVector(i + 20000) - origin);
      smallest = std::min(smallest, axis.dot(shape.local_from_world.transpose() * local + shape.center));
    }
    EXPECT_GE(smallest, bound - 1e-9);
    EXPECT_LE(smallest, bound + 0.05);
  }
}

TEST(SceneShape, CapsulesReachFromEndToEnd) {
  const Vector3d a(0.1, 0.2, 2);
  const Vector3d b(0.7, -0.4, 2.5);
  const Shape rod = CapsuleBetween(a, b, 0.01);
  EXPECT_NEAR(SmallestAlong(rod, Vector3d::UnitX()), 0.09, 1e-12);
  EXPECT_NEAR(-SmallestAlong(rod, -Vector3d::UnitX()), 0.71, 1e-12);
  EXPECT_NEAR(-SmallestAlong(rod, -Vector3d::UnitZ()), 2.51, 1e-12);
  EXPECT_NEAR(rod.local_from_world.determinant(), 1, 1e-12);
}

TEST(SceneShape, CapsulesAlongTheForwardDirectionAreWellFormed) {
  const Shape rod = CapsuleBetween(Vector3d::Zero(), Vector3d::UnitZ(), 0.01, Vector3d::UnitZ());
  EXPECT_TRUE((rod.local_from_world * rod.local_from_world.transpose()).isIdentity(1e-12));
}

}  // namespace
}  // namespace depthfarm
