#include "common/scene/shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace depthfarm {
namespace {

using Eigen::Vector3d;

// Smaller root of a t^2 + 2 b t + c = 0 with a > 0; -1 when there is none. Outside the solid c > 0, so that a smaller
// root > 0 is an entry and roots of both signs cannot occur.
double EntryRoot(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return -1;
  return (-b - std::sqrt(discriminant)) / a;
}

double HitPlane(const Vector3d& origin, const Vector3d& direction) {
  if (direction.z() == 0) return 0;
  return std::max(0.0, -origin.z() / direction.z());
}

double HitBox(const Vector3d& half, const Vector3d& origin, const Vector3d& direction) {
  double enter = 0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (std::abs(origin[axis]) > half[axis]) return 0;
      continue;
    }
    double first = (-half[axis] - origin[axis]) / direction[axis];
    double second = (half[axis] - origin[axis]) / direction[axis];
    if (first > second) std::swap(first, second);
    enter = std::max(enter, first);
    leave = std::min(leave, second);
  }
  return enter <= leave ? enter : 0;
}

double HitEllipsoid(const Vector3d& radii, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d o = origin.cwiseQuotient(radii);
  const Vector3d d = direction.cwiseQuotient(radii);
  return std::max(0.0, EntryRoot(d.dot(d), o.dot(d), o.dot(o) - 1));
}

// Side of an endless cylinder around y, kept where |y| <= half_length.
double HitSide(double radius, double half_length, const Vector3d& origin, const Vector3d& direction) {
  const double a = direction.x() * direction.x() + direction.z() * direction.z();
  if (a == 0) return 0;
  const double b = origin.x() * direction.x() + origin.z() * direction.z();
  const double c = origin.x() * origin.x() + origin.z() * origin.z() - radius * radius;
  const double t = EntryRoot(a, b, c);
  if (t <= 0 || std::abs(origin.y() + t * direction.y()) > half_length) return 0;
  return t;
}

double HitCylinder(double radius, double half_length, const Vector3d& origin, const Vector3d& direction) {
  const double side = HitSide(radius, half_length, origin, direction);
  if (side > 0 || direction.y() == 0) return side;
  // The near disc lies on the side of the origin.
  const double t = ((origin.y() < 0 ? -half_length : half_length) - origin.y()) / direction.y();
  if (t <= 0) return 0;
  const double x = origin.x() + t * direction.x();
  const double z = origin.z() + t * direction.z();
  return x * x + z * z <= radius * radius ? t : 0;
}

double HitCapsule(double radius, double half_length, const Vector3d& origin, const Vector3d& direction) {
  double nearest = HitSide(radius, half_length, origin, direction);
  for (const double end : {-half_length, half_length}) {
    const Vector3d o = origin - Vector3d(0, end, 0);
    const double t = EntryRoot(direction.dot(direction), o.dot(direction), o.dot(o) - radius * radius);
    if (t > 0 && (nearest == 0 || t < nearest)) nearest = t;
  }
  return nearest;
}

int LargestAxis(const Vector3d& v) {
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(v[i]) > std::abs(v[axis])) axis = i;
  }
  return axis;
}

}  // namespace

Shape CapsuleBetween(const Vector3d& a, const Vector3d& b, double radius, const Vector3d& forward) {
  Shape shape;
  shape.kind = Shape::Kind::kCapsule;
  shape.center = 0.5 * (a + b);
  shape.extent = Vector3d(radius, 0.5 * (b - a).norm(), radius);
  const Vector3d y = (b - a).normalized();
  Vector3d x = y.cross(forward);
  if (x.norm() < 1e-6) x = y.cross(y.unitOrthogonal());  // a capsule along `forward`: any turn will do
  x.normalize();
  shape.local_from_world.row(0) = x.transpose();
  shape.local_from_world.row(1) = y.transpose();
  shape.local_from_world.row(2) = x.cross(y).transpose();
  return shape;
}

Eigen::Matrix3d TurnedBy(double angle) { return Eigen::AngleAxisd(-angle, Vector3d::UnitY()).toRotationMatrix(); }

Vector3d LocalBounds(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::kCylinder:
      return {shape.extent.x(), shape.extent.y(), shape.extent.x()};
    case Shape::Kind::kCapsule:
      return {shape.extent.x(), shape.extent.y() + shape.extent.x(), shape.extent.x()};
    case Shape::Kind::kPlane:
    case Shape::Kind::kBox:
    case Shape::Kind::kEllipsoid:
      break;
  }
  return shape.extent;
}

double SmallestAlong(const Shape& shape, const Vector3d& direction) {
  const Vector3d d = shape.local_from_world * direction;
  double reach = 0;
  switch (shape.kind) {
    case Shape::Kind::kPlane:
    case Shape::Kind::kBox:
      reach = shape.extent.dot(d.cwiseAbs());
      break;
    case Shape::Kind::kEllipsoid:
      reach = shape.extent.cwiseProduct(d).norm();
      break;
    case Shape::Kind::kCylinder:
      reach = shape.extent.x() * std::sqrt(d.x() * d.x() + d.z() * d.z()) + shape.extent.y() * std::abs(d.y());
      break;
    case Shape::Kind::kCapsule:
      reach = shape.extent.x() + shape.extent.y() * std::abs(d.y());
      break;
  }
  return direction.dot(shape.center) - reach;
}

double FirstHit(const Shape& shape, const Vector3d& origin, const Vector3d& direction) {
  switch (shape.kind) {
    case Shape::Kind::kPlane:
      return HitPlane(origin, direction);
    case Shape::Kind::kBox:
      return HitBox(shape.extent, origin, direction);
    case Shape::Kind::kEllipsoid:
      return HitEllipsoid(shape.extent, origin, direction);
    case Shape::Kind::kCylinder:
      return HitCylinder(shape.extent.x(), shape.extent.y(), origin, direction);
    case Shape::Kind::kCapsule:
      return HitCapsule(shape.extent.x(), shape.extent.y(), origin, direction);
  }
  return 0;
}

Vector3d LocalNormal(const Shape& shape, const Vector3d& point) {
  switch (shape.kind) {
    case Shape::Kind::kPlane:
      break;
    case Shape::Kind::kBox: {
      const int axis = LargestAxis(point.cwiseQuotient(shape.extent));
      Vector3d normal = Vector3d::Zero();
      normal[axis] = point[axis] < 0 ? -1 : 1;
      return normal;
    }
    case Shape::Kind::kEllipsoid:
      return point.cwiseQuotient(shape.extent.cwiseProduct(shape.extent)).normalized();
    case Shape::Kind::kCylinder: {
      const double off_axis = std::sqrt(point.x() * point.x() + point.z() * point.z());
      if (shape.extent.y() - std::abs(point.y()) < shape.extent.x() - off_axis) {
        return {0, point.y() < 0 ? -1.0 : 1.0, 0};
      }
      return {point.x() / off_axis, 0, point.z() / off_axis};
    }
    case Shape::Kind::kCapsule: {
      const double on_axis = std::clamp(point.y(), -shape.extent.y(), shape.extent.y());
      return Vector3d(point.x(), point.y() - on_axis, point.z()).normalized();
    }
  }
  return Vector3d::UnitZ();
}

Eigen::Vector2d SurfaceCoordinates(const Shape& shape, const Vector3d& point, const Vector3d& normal) {
  switch (shape.kind) {
    case Shape::Kind::kPlane:
      break;
    case Shape::Kind::kBox:
      switch (LargestAxis(normal)) {
        case 0:
          return {point.z(), point.y()};
        case 1:
          return {point.x(), point.z()};
        default:
          break;
      }
      break;
    case Shape::Kind::kEllipsoid:
    case Shape::Kind::kCylinder:
    case Shape::Kind::kCapsule:
      return {std::atan2(point.x(), -point.z()) * shape.extent.x(), point.y()};
  }
  return {point.x(), point.y()};
}

}  // namespace depthfarm
