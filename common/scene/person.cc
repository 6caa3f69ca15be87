#include "common/scene/person.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

namespace depthfarm {
namespace {

using Eigen::Vector3d;

// Builds solids in the figure's own frame: feet at the origin, x to its left hand as the cameras see it, y down, facing
// -z, lengths in units of a figure 1.75 m tall.
class Figure {
 public:
  Figure(const Vector3d& feet_in_world, double scale, double turn)
      : feet_(feet_in_world), scale_(scale), person_from_world_(TurnedBy(turn)) {}

  void Limb(const Vector3d& a, const Vector3d& b, double radius, int material) {
    Shape shape = CapsuleBetween(InWorld(a), InWorld(b), scale_ * radius, person_from_world_.row(2).transpose());
    Add(shape, material);
  }
  void Ellipsoid(const Vector3d& center, const Vector3d& radii, int material) {
    Shape shape;
    shape.kind = Shape::Kind::kEllipsoid;
    shape.center = InWorld(center);
    shape.extent = scale_ * radii;
    shape.local_from_world = person_from_world_;
    Add(shape, material);
  }
  [[nodiscard]] std::vector<Shape> Take() { return std::move(shapes_); }

 private:
  [[nodiscard]] Vector3d InWorld(const Vector3d& p) const {
    return feet_ + person_from_world_.transpose() * (scale_ * p);
  }
  void Add(Shape& shape, int material) {
    shape.zone = Zone::kPerson;
    shape.material = material;
    shapes_.push_back(shape);
  }

  Vector3d feet_;
  double scale_;
  Eigen::Matrix3d person_from_world_;
  std::vector<Shape> shapes_;
};

// A point `length` from `from`, hanging down and swung forward (towards -z) by `swing` and outward by `spread` radians.
Vector3d Swung(const Vector3d& from, double length, double swing, double spread = 0) {
  return from +
         length * Vector3d(std::sin(spread), std::cos(swing) * std::cos(spread), -std::sin(swing) * std::cos(spread));
}

void AddLeg(Figure& figure, const Person& person, double side, double swing) {
  const Vector3d hip(0.095 * side, -0.92, 0);
  const Vector3d knee = Swung(hip, 0.43, swing);
  const double bend = 0.15 * std::abs(swing) + std::max(0.0, -0.9 * swing);  // the leg behind bends at the knee
  const Vector3d ankle = Swung(knee, 0.42, swing - bend);
  figure.Limb(hip, knee, 0.085, person.trousers);
  figure.Limb(knee, ankle, 0.062, person.trousers);
  figure.Ellipsoid(ankle + Vector3d(0, 0.035, -0.06), Vector3d(0.05, 0.042, 0.13), person.shoes);
}

void AddArm(Figure& figure, const Person& person, double side, double swing, double spread, double bend) {
  const Vector3d shoulder(0.2 * side, -1.41, 0.01);
  const Vector3d elbow = Swung(shoulder, 0.28, swing, side * spread);
  const Vector3d wrist = Swung(elbow, 0.25, swing + bend, side * spread * 0.6);
  figure.Limb(shoulder, elbow, 0.052, person.shirt);
  figure.Limb(elbow, wrist, 0.042, person.shirt);
  figure.Ellipsoid(Swung(wrist, 0.07, swing + bend, side * spread * 0.6), Vector3d(0.036, 0.06, 0.045), person.skin);
}

}  // namespace

std::vector<Shape> PosedPerson(const Person& person, int frame) {
  const double walk = 2 * std::numbers::pi * frame / person.walk_frames + person.phase;
  const double speed = std::cos(walk);  // -1 to 1 of the largest, towards +x
  // Turns its side to the cameras while walking and its face while turning round.
  const double stride = person.walk_m > 0.1 ? 1.0 : 0.0;
  const double turn = person.facing - stride * 0.95 * speed;
  const double step = 2 * std::numbers::pi * frame / 28.0 + person.phase;  // a pair of steps takes about a second
  const double swing = stride * 0.42 * std::abs(speed) * std::sin(step);
  const double bob = stride * 0.015 * std::abs(speed) * std::cos(2 * step);
  Figure figure(person.place + Vector3d(person.walk_m * std::sin(walk), bob, 0), person.height_m / 1.75, turn);

  AddLeg(figure, person, -1, swing + 0.03);
  AddLeg(figure, person, 1, -swing + 0.03);
  figure.Ellipsoid(Vector3d(0, -0.95, 0), Vector3d(0.165, 0.13, 0.115), person.trousers);
  figure.Ellipsoid(Vector3d(0, -1.16, 0), Vector3d(0.168, 0.3, 0.12), person.shirt);
  figure.Ellipsoid(Vector3d(0, -1.3, 0.003), Vector3d(0.2, 0.21, 0.123), person.shirt);
  figure.Limb(Vector3d(0, -1.42, 0.01), Vector3d(0, -1.52, 0), 0.052, person.skin);

  const double waving = std::sin(2 * std::numbers::pi * frame / 24.0);
  const double idle = 0.04 * std::sin(2 * std::numbers::pi * frame / 50.0);
  AddArm(figure, person, -1, -0.8 * swing + idle, 0.14, 0.35);
  AddArm(figure, person, 1, 0.8 * swing - idle + 1.0 * person.wave, 0.14 + person.wave * (0.45 + 0.15 * waving),
         0.35 + person.wave * (1.1 + 0.25 * waving));

  const Vector3d head(0, -1.63, -0.01);
  figure.Ellipsoid(head, Vector3d(0.078, 0.115, 0.095), person.skin);
  figure.Ellipsoid(head + Vector3d(0, -0.028, 0.022), Vector3d(0.088, 0.108, 0.098), person.hair);
  figure.Ellipsoid(head + Vector3d(0, 0.02, -0.1), Vector3d(0.014, 0.022, 0.018), person.skin);  // nose
  for (const double side : {-1.0, 1.0}) {
    figure.Ellipsoid(head + Vector3d(0.03 * side, -0.005, -0.084), Vector3d(0.013, 0.009, 0.01), person.hair);  // eyes
  }
  return figure.Take();
}

}  // namespace depthfarm
