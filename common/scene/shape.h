#ifndef DEPTHFARM_COMMON_SCENE_SHAPE_H_
#define DEPTHFARM_COMMON_SCENE_SHAPE_H_

#include <Eigen/Core>

#include "common/scene/zone.h"

namespace depthfarm {

// One solid of a scene in its own frame, local = local_from_world * (world - center), with x right, y down, z forward
// when local_from_world is the identity. Metres. What is painted on it is fixed to that frame and so moves with it.
struct Shape {
  enum class Kind {
    kPlane,      // local z = 0, without bounds
    kBox,        // |local| <= extent
    kEllipsoid,  // radii `extent`
    kCylinder,   // round around local y: radius extent.x, |y| <= extent.y, closed by discs
    kCapsule,    // points within extent.x of the segment |y| <= extent.y of the local y axis
  };
  Kind kind = Kind::kPlane;
  Zone zone = Zone::kTextured;
  int material = 0;  // index into Scene::materials
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d local_from_world = Eigen::Matrix3d::Identity();
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
};

// A capsule from `a` to `b`; `forward` fixes its turn around its own axis.
[[nodiscard]] Shape CapsuleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius,
                                   const Eigen::Vector3d& forward = Eigen::Vector3d::UnitZ());

// Turn by `angle` radians around the world's downward axis: local_from_world of something that faces -z and turns to
// -x.
[[nodiscard]] Eigen::Matrix3d TurnedBy(double angle);

// Half sizes of the axis-parallel box around the solid in its own frame. Not for planes.
[[nodiscard]] Eigen::Vector3d LocalBounds(const Shape& shape);

// Smallest value of direction . X over the world points X of the solid (its nearest depth, `direction` being an optical
// axis). `direction` has length 1. Not for planes.
[[nodiscard]] double SmallestAlong(const Shape& shape, const Eigen::Vector3d& direction);

// Where the ray origin + t * direction (both in the shape's frame, direction of any length) first enters the solid from
// outside at t > 0; 0 when it does not. Planes are met from both sides.
[[nodiscard]] double FirstHit(const Shape& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

// Outward unit normal in the shape's frame at a point of its surface; +z or -z of a plane is decided by the caller.
[[nodiscard]] Eigen::Vector3d LocalNormal(const Shape& shape, const Eigen::Vector3d& point);

// Metres along the surface at a point of it, for patterns painted on it: x across, y down (a box face by face, round
// solids unrolled around their y axis).
[[nodiscard]] Eigen::Vector2d SurfaceCoordinates(const Shape& shape, const Eigen::Vector3d& point,
                                                 const Eigen::Vector3d& normal);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_SHAPE_H_
