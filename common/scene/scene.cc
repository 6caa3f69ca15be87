#include "common/scene/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "common/scene/hash.h"

namespace depthfarm {
namespace {

using Eigen::Vector3d;
using Pattern = Material::Pattern;

constexpr double kFloor = 1.35;
constexpr double kWall = 7.0;

// Lays out the scene. Each named thing draws from its own key, so that adding one leaves the others where they are.
class Builder {
 public:
  explicit Builder(std::uint64_t seed) { scene_.seed = seed; }

  [[nodiscard]] Scene Build() {
    AddRoom();
    AddPanel();
    AddCrates();
    AddRoundThings();
    AddLamp();
    AddRailing();
    AddPersons();
    return std::move(scene_);
  }

 private:
  [[nodiscard]] double Draw(std::string_view name, std::uint64_t counter, double low, double high) const {
    return Uniform(DerivedKey(scene_.seed, name), counter, low, high);
  }

  // `material` with its colours moved a little and its own texture.
  int AddMaterial(std::string_view name, Material material) {
    material.seed = DerivedKey(scene_.seed, name);
    for (int channel = 0; channel < 3; ++channel) {
      const double tint = Uniform(material.seed, channel, 0.9, 1.1);
      material.base[channel] = std::min(235.0, material.base[channel] * tint);
      material.accent[channel] = std::min(235.0, material.accent[channel] * tint);
    }
    scene_.materials.push_back(material);
    return static_cast<int>(scene_.materials.size()) - 1;
  }

  Shape& Add(Shape::Kind kind, Zone zone, int material, const Vector3d& center, const Vector3d& extent,
             double turn = 0) {
    Shape shape;
    shape.kind = kind;
    shape.zone = zone;
    shape.material = material;
    shape.center = center;
    shape.extent = extent;
    shape.local_from_world = TurnedBy(turn);
    scene_.still.push_back(shape);
    return scene_.still.back();
  }

  void AddRod(const Vector3d& a, const Vector3d& b, double radius, int material) {
    Shape rod = CapsuleBetween(a, b, radius);
    rod.zone = Zone::kThin;
    rod.material = material;
    scene_.still.push_back(rod);
  }

  void AddRoom() {
    const int bricks = AddMaterial("bricks", {.pattern = Pattern::kBricks,
                                              .base = Rgb(158, 118, 100),
                                              .accent = Rgb(194, 158, 132),
                                              .line = Rgb(196, 188, 176),
                                              .cell_m = 0.16,
                                              .contrast = 0.12,
                                              .coarsest_m = 0.2});
    Add(Shape::Kind::kPlane, Zone::kTextured, bricks, Vector3d(0, kFloor, kWall), Vector3d::Zero());

    const int boards = AddMaterial("boards", {.pattern = Pattern::kPlanks,
                                              .base = Rgb(150, 116, 80),
                                              .accent = Rgb(190, 158, 118),
                                              .line = Rgb(60, 44, 32),
                                              .cell_m = 0.17,
                                              .contrast = 0.12,
                                              .coarsest_m = 0.15});
    Shape& floor = Add(Shape::Kind::kPlane, Zone::kSlanted, boards, Vector3d(0, kFloor, 0), Vector3d::Zero());
    floor.local_from_world << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // boards run away from the cameras

    const int curtain = AddMaterial("curtain", {.pattern = Pattern::kStripes,
                                                .base = Rgb(70, 104, 112),
                                                .accent = Rgb(112, 148, 150),
                                                .cell_m = 0.31,
                                                .contrast = 0.16,
                                                .coarsest_m = 0.3});
    // Turned about the vertical so that it meets the back wall at x = -2.35 and opens towards the cameras.
    Add(Shape::Kind::kPlane, Zone::kSlanted, curtain, Vector3d(-2.35, 0, kWall), Vector3d::Zero(),
        -Draw("curtain turn", 0, 1.3, 1.36));
  }

  void AddPanel() {
    const int plain = AddMaterial("panel", {.pattern = Pattern::kPlain, .base = Rgb(176, 178, 172), .contrast = 0});
    const int frame = AddMaterial("panel frame", {.base = Rgb(56, 50, 46), .accent = Rgb(74, 66, 58), .contrast = 0.2});
    const Vector3d middle(Draw("panel", 0, -0.4, -0.2), Draw("panel", 1, -0.62, -0.52), kWall - 0.02);
    const Vector3d half(Draw("panel", 2, 1.16, 1.2), Draw("panel", 3, 0.82, 0.86), 0.02);
    Add(Shape::Kind::kBox, Zone::kPanel, plain, middle, half);
    constexpr double kBar = 0.03;
    for (const double side : {-1.0, 1.0}) {
      Add(Shape::Kind::kBox, Zone::kTextured, frame, middle + Vector3d(side * (half.x() + kBar), 0, -0.015),
          Vector3d(kBar, half.y() + 2 * kBar, 0.035));
      Add(Shape::Kind::kBox, Zone::kTextured, frame, middle + Vector3d(0, side * (half.y() + kBar), -0.015),
          Vector3d(half.x(), kBar, 0.035));
    }
  }

  // A box that stands on something whose top is at `ground`.
  void Crate(std::string_view name, int material, double x, double z, const Vector3d& half, double ground) {
    Add(Shape::Kind::kBox, Zone::kBox, material,
        Vector3d(x + Draw(name, 0, -0.06, 0.06), ground - half.y(), z + Draw(name, 1, -0.06, 0.06)), half,
        Draw(name, 2, 0.25, 0.6) * (Draw(name, 3, 0, 1) < 0.5 ? -1 : 1));
  }

  void AddCrates() {
    const int wood = AddMaterial("crate wood", {.pattern = Pattern::kPlanks,
                                                .base = Rgb(176, 134, 78),
                                                .accent = Rgb(206, 170, 112),
                                                .line = Rgb(84, 60, 36),
                                                .cell_m = 0.11,
                                                .contrast = 0.14,
                                                .coarsest_m = 0.15});
    const int card = AddMaterial("cardboard", {.pattern = Pattern::kChecks,
                                               .base = Rgb(84, 118, 92),
                                               .accent = Rgb(124, 152, 116),
                                               .line = Rgb(212, 206, 180),
                                               .cell_m = 0.12,
                                               .contrast = 0.14,
                                               .coarsest_m = 0.12});
    const int blue = AddMaterial(
        "blue crate", {.base = Rgb(66, 88, 146), .accent = Rgb(104, 126, 170), .contrast = 0.16, .coarsest_m = 0.16});
    Crate("low crate", wood, -1.4, 5.0, Vector3d(0.34, 0.27, 0.3), kFloor);
    Crate("upper crate", card, -1.42, 5.02, Vector3d(0.2, 0.16, 0.18), kFloor - 0.54);
    Crate("tall crate", blue, 1.95, 5.7, Vector3d(0.28, 0.55, 0.28), kFloor);
    Crate("small crate", card, 0.3, 5.9, Vector3d(0.3, 0.22, 0.24), kFloor);
  }

  void AddRoundThings() {
    const int ball = AddMaterial(
        "ball", {.base = Rgb(196, 84, 60), .accent = Rgb(222, 176, 84), .contrast = 0.16, .coarsest_m = 0.1});
    const int barrel = AddMaterial("barrel", {.pattern = Pattern::kStripes,
                                              .base = Rgb(92, 122, 132),
                                              .accent = Rgb(132, 156, 158),
                                              .cell_m = 0.13,
                                              .contrast = 0.16,
                                              .coarsest_m = 0.12});
    const int column = AddMaterial(
        "column", {.base = Rgb(164, 158, 146), .accent = Rgb(196, 188, 172), .contrast = 0.13, .coarsest_m = 0.2});
    const double radius = Draw("ball", 0, 0.14, 0.17);
    Add(Shape::Kind::kEllipsoid, Zone::kCurved, ball,
        Vector3d(Draw("ball", 1, -0.5, -0.3), kFloor - radius, Draw("ball", 2, 3.95, 4.1)), Vector3d::Constant(radius));
    const double globe = Draw("globe", 0, 0.16, 0.2);
    Add(Shape::Kind::kEllipsoid, Zone::kCurved, ball, Vector3d(1.95, kFloor - 1.1 - globe, 5.7),
        Vector3d::Constant(globe));
    Add(Shape::Kind::kCylinder, Zone::kCurved, barrel,
        Vector3d(Draw("barrel", 0, -0.75, -0.6), kFloor - 0.38, Draw("barrel", 1, 5.5, 5.7)),
        Vector3d(0.27, 0.38, 0.27));
    Add(Shape::Kind::kCylinder, Zone::kCurved, column, Vector3d(Draw("column", 0, 2.5, 2.6), -1.0, 6.5),
        Vector3d(Draw("column", 1, 0.27, 0.33), 4.0, 0.3));
  }

  // A lamp stand with a slanted boom: thin things before the wall and before the panel.
  void AddLamp() {
    const int metal = AddMaterial(
        "metal", {.base = Rgb(52, 54, 58), .accent = Rgb(82, 84, 88), .contrast = 0.16, .coarsest_m = 0.08});
    const int shade = AddMaterial(
        "shade", {.base = Rgb(220, 204, 160), .accent = Rgb(232, 222, 190), .contrast = 0.12, .coarsest_m = 0.08});
    const Vector3d foot(Draw("lamp", 0, -0.84, -0.76), kFloor, Draw("lamp", 1, 4.1, 4.25));
    const Vector3d top = foot + Vector3d(0, -2.1, 0);
    AddRod(foot, top, 0.0095, metal);
    Add(Shape::Kind::kCylinder, Zone::kCurved, metal, foot + Vector3d(0, -0.02, 0), Vector3d(0.15, 0.02, 0.15));
    Add(Shape::Kind::kEllipsoid, Zone::kCurved, shade, top + Vector3d(0, -0.06, 0), Vector3d(0.13, 0.11, 0.13));
    const Vector3d joint = foot + Vector3d(0, -1.75, 0);
    const Vector3d end = joint + Vector3d(Draw("boom", 0, 1.2, 1.35), Draw("boom", 1, -0.6, -0.5), 0.12);
    AddRod(joint + 0.18 * (joint - end), end, 0.008, metal);
    Shape microphone = CapsuleBetween(end, end + Vector3d(0.1, 0.06, 0), 0.028);
    microphone.zone = Zone::kCurved;
    microphone.material = metal;
    scene_.still.push_back(microphone);
  }

  void AddRailing() {
    const int paint = AddMaterial(
        "railing", {.base = Rgb(206, 200, 188), .accent = Rgb(226, 220, 206), .contrast = 0.15, .coarsest_m = 0.06});
    constexpr int kRods = 9;
    const Vector3d from(Draw("railing", 0, 0.28, 0.36), kFloor - 0.02, Draw("railing", 1, 3.7, 3.8));
    const Vector3d to = from + Vector3d(Draw("railing", 2, 1.05, 1.15), 0, Draw("railing", 3, 0.25, 0.4));
    const Vector3d up(0, -0.66, 0);
    AddRod(from + up, to + up, 0.01, paint);
    AddRod(from + 0.12 * up, to + 0.12 * up, 0.008, paint);
    for (int i = 0; i < kRods; ++i) {
      const Vector3d at = from + (to - from) * (static_cast<double>(i) / (kRods - 1));
      const bool post = i == 0 || i == kRods - 1;
      AddRod(post ? at : at + 0.12 * up, at + up, post ? 0.0095 : 0.007, paint);
    }
  }

  void AddPersons() {
    const int skin = AddMaterial(
        "skin", {.base = Rgb(206, 156, 128), .accent = Rgb(216, 170, 142), .contrast = 0.07, .coarsest_m = 0.06});
    const int hair =
        AddMaterial("hair", {.base = Rgb(58, 42, 34), .accent = Rgb(84, 62, 46), .contrast = 0.28, .coarsest_m = 0.05});
    const int shoes = AddMaterial(
        "shoes", {.base = Rgb(48, 44, 44), .accent = Rgb(72, 64, 58), .contrast = 0.16, .coarsest_m = 0.06});
    const int jeans = AddMaterial(
        "jeans", {.base = Rgb(62, 78, 112), .accent = Rgb(90, 108, 140), .contrast = 0.16, .coarsest_m = 0.1});
    const int checked = AddMaterial("checked shirt", {.pattern = Pattern::kChecks,
                                                      .base = Rgb(150, 52, 50),
                                                      .accent = Rgb(206, 120, 96),
                                                      .line = Rgb(236, 222, 190),
                                                      .cell_m = 0.085,
                                                      .contrast = 0.14,
                                                      .coarsest_m = 0.08});
    const int plain_trousers = AddMaterial(
        "trousers", {.base = Rgb(112, 98, 80), .accent = Rgb(138, 122, 98), .contrast = 0.18, .coarsest_m = 0.1});
    const int jumper = AddMaterial(
        "jumper", {.base = Rgb(62, 120, 104), .accent = Rgb(120, 166, 120), .contrast = 0.16, .coarsest_m = 0.12});
    scene_.persons.push_back({.place = Vector3d(Draw("walker", 0, -0.35, -0.25), kFloor, Draw("walker", 1, 4.5, 4.7)),
                              .height_m = Draw("walker", 2, 1.7, 1.8),
                              .walk_m = Draw("walker", 3, 0.3, 0.36),
                              .walk_frames = 64,
                              .phase = Draw("walker", 4, -0.6, 0.6),
                              .skin = skin,
                              .hair = hair,
                              .shirt = checked,
                              .trousers = jeans,
                              .shoes = shoes});
    scene_.persons.push_back({.place = Vector3d(Draw("waver", 0, 0.98, 1.08), kFloor, Draw("waver", 1, 5.0, 5.2)),
                              .height_m = Draw("waver", 2, 1.62, 1.72),
                              .walk_m = 0.015,
                              .walk_frames = 90,
                              .phase = Draw("waver", 3, 0, 6),
                              .facing = Draw("waver", 4, 0.2, 0.45),
                              .wave = 1,
                              .skin = skin,
                              .hair = hair,
                              .shirt = jumper,
                              .trousers = plain_trousers,
                              .shoes = shoes});
  }

  Scene scene_;
};

}  // namespace

Scene MakeScene(std::uint64_t seed) { return Builder(seed).Build(); }

std::vector<Shape> ShapesAt(const Scene& scene, int frame) {
  std::vector<Shape> shapes = scene.still;
  for (const Person& person : scene.persons) {
    const std::vector<Shape> posed = PosedPerson(person, frame);
    shapes.insert(shapes.end(), posed.begin(), posed.end());
  }
  return shapes;
}

Result<DepthRange> SceneDepthRange(const Scene& scene, std::span<const Camera> cameras, const Camera& reference,
                                   int frames) {
  constexpr int kSamples = 64;  // a side, of each picture, borders included
  constexpr double kMargin = 1.02;
  const Vector3d axis = OpticalAxisInWorld(reference);
  const double offset = reference.cam_from_world_translation.z();
  DepthRange range{.z_near = std::numeric_limits<double>::infinity(), .z_far = 0};

  // Only planes: objects hide them, so what is found this way can only be farther than what is visible.
  for (const Camera& camera : cameras) {
    const Vector3d center = CenterInWorld(camera);
    const Eigen::Matrix3d world_from_pixel =
        camera.cam_from_world_rotation.transpose() * InverseIntrinsics(camera.intrinsics);
    for (int i = 0; i < kSamples * kSamples; ++i) {
      const Vector3d pixel((camera.width - 1) * (i % kSamples) / (kSamples - 1.0),
                           (camera.height - 1) * (i / kSamples) / (kSamples - 1.0), 1);
      const Vector3d direction = world_from_pixel * pixel;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Shape& shape : scene.still) {
        if (shape.kind != Shape::Kind::kPlane) continue;
        const double t =
            FirstHit(shape, shape.local_from_world * (center - shape.center), shape.local_from_world * direction);
        if (t > 0) nearest = std::min(nearest, t);
      }
      if (!std::isfinite(nearest)) continue;
      const double depth = axis.dot(center + nearest * direction) + offset;
      range.z_near = std::min(range.z_near, depth);
      range.z_far = std::max(range.z_far, depth);
    }
  }
  const auto include = [&](const Shape& shape) {
    if (shape.kind != Shape::Kind::kPlane) range.z_near = std::min(range.z_near, SmallestAlong(shape, axis) + offset);
  };
  for (const Shape& shape : scene.still) include(shape);
  for (const Person& person : scene.persons) {
    for (int frame = 0; frame < frames; ++frame) {
      for (const Shape& shape : PosedPerson(person, frame)) include(shape);
    }
  }
  if (!(range.z_near > 0) || !(range.z_far > range.z_near)) {
    return InvalidArgument("scene: its nearest and farthest depths in camera '" + reference.name + "' are " +
                           std::to_string(range.z_near) + " and " + std::to_string(range.z_far) +
                           " m, expected 0 < nearest < farthest: use fewer cameras or a narrower picture");
  }
  return DepthRange{.z_near = range.z_near / kMargin, .z_far = range.z_far * kMargin};
}

}  // namespace depthfarm
