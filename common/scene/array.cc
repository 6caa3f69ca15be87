#include "common/scene/array.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "common/scene/hash.h"

namespace depthfarm {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// What all cameras look at: among the persons, a little below the eyes of the cameras.
const Eigen::Vector3d kTarget(0.0, 0.2, 4.2);

constexpr double kArcStep = 3.5 * kDegree;
constexpr double kMaxArc = 56.0 * kDegree;
constexpr double kLineStep_m = 0.25;
constexpr double kMaxLine_m = 1.9;
constexpr double kMaxRise_m = 1.2;  // higher cameras would look over the wall, lower ones stand in the floor

// A focal length that sees the same share of the scene at any aspect ratio: 1024 pixels at 1024 x 768.
double FocalLength(int width, int height) {
  const double same_area = std::sqrt(4.0 / 3.0 * width * height);
  return std::max(same_area, 0.5 * std::max(width, height));  // no side beyond 90 degrees
}

Eigen::Matrix3d Intrinsics(int width, int height) {
  const double focal_px = FocalLength(width, height);
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k(0, 0) = focal_px;
  k(1, 1) = focal_px;
  k(0, 2) = (width - 1) / 2.0;
  k(1, 2) = (height - 1) / 2.0;
  return k;
}

// Rows: right, down and forward of a level camera at `center` that looks at `target`.
Eigen::Matrix3d LookingAt(const Eigen::Vector3d& center, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - center).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(forward).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = right.transpose();
  rotation.row(1) = forward.cross(right).transpose();
  rotation.row(2) = forward.transpose();
  return rotation;
}

void Place(Camera& camera, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& center) {
  camera.cam_from_world_rotation = rotation;
  camera.cam_from_world_translation = -(rotation * center);
}

// Offset of position `index` of `count` from their middle, `step` apart but within `max_span` altogether.
double Spread(int index, int count, double step, double max_span) {
  if (count < 2) return 0;
  return (index - (count - 1) / 2.0) * std::min(step, max_span / (count - 1));
}

struct GridShape {
  int columns = 1;
  int rows = 1;
};

GridShape AboutSquare(int cameras) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(cameras))));
  return {columns, (cameras + columns - 1) / columns};
}

void PlaceOnGrid(std::vector<Camera>& cameras) {
  const GridShape shape = AboutSquare(static_cast<int>(cameras.size()));
  const Eigen::Matrix3d rotation = LookingAt(Eigen::Vector3d::Zero(), kTarget);
  for (int i = 0; i < static_cast<int>(cameras.size()); ++i) {
    const Eigen::Vector3d center_in_array(Spread(i % shape.columns, shape.columns, kLineStep_m, kMaxLine_m),
                                          Spread(i / shape.columns, shape.rows, kLineStep_m, kMaxRise_m), 0);
    Place(cameras[i], rotation, rotation.transpose() * center_in_array);
  }
}

void PlaceIrregularly(std::vector<Camera>& cameras, std::uint64_t seed) {
  const int count = static_cast<int>(cameras.size());
  const int columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(2.0 * count))));
  const int rows = (count + columns - 1) / columns;
  std::vector<std::pair<std::uint64_t, int>> order;  // places in no order: nothing may rely on the order of the file
  for (int i = 0; i < count; ++i) order.emplace_back(DerivedKey(DerivedKey(seed, "order"), i), i);
  std::sort(order.begin(), order.end());
  for (int i = 0; i < count; ++i) {
    Camera& camera = cameras[i];
    const int place = order[i].second;
    const std::uint64_t key = DerivedKey(DerivedKey(seed, "place"), place);
    const Eigen::Vector3d center(
        Spread(place % columns, columns, kLineStep_m, kMaxLine_m) + Uniform(key, 0, -0.07, 0.07),
        Spread(place / columns, rows, kLineStep_m, kMaxRise_m) + Uniform(key, 1, -0.07, 0.07),
        Uniform(key, 2, -0.15, 0.15));
    const Eigen::Vector3d target =
        kTarget + Eigen::Vector3d(Uniform(key, 3, -0.15, 0.15), Uniform(key, 4, -0.08, 0.08), 0);
    const double roll = Uniform(key, 5, -3.0, 3.0) * kDegree;
    const Eigen::Matrix3d rolled = Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Place(camera, rolled * LookingAt(center, target), center);
    const double zoom = Uniform(key, 6, 0.96, 1.04);
    camera.intrinsics(0, 0) *= zoom;
    camera.intrinsics(1, 1) *= zoom * Uniform(key, 7, 0.997, 1.003);
    camera.intrinsics(0, 2) += Uniform(key, 8, -0.01, 0.01) * camera.width;
    camera.intrinsics(1, 2) += Uniform(key, 9, -0.01, 0.01) * camera.height;
  }
}

}  // namespace

Result<ArrayKind> ParseArrayKind(std::string_view name) {
  if (name == "arc") return ArrayKind::kArc;
  if (name == "line") return ArrayKind::kLine;
  if (name == "grid") return ArrayKind::kGrid;
  if (name == "irregular") return ArrayKind::kIrregular;
  if (name == "mixed") return ArrayKind::kMixed;
  return InvalidArgument("kind of camera array is '" + std::string(name) +
                         "', expected arc, line, grid, irregular or mixed");
}

std::vector<Camera> MakeArray(ArrayKind kind, int cameras, int width, int height, std::uint64_t seed) {
  std::vector<Camera> result(cameras);
  for (int i = 0; i < cameras; ++i) {
    Camera& camera = result[i];
    camera.name = "cam" + std::to_string(i);
    camera.width = width;
    camera.height = height;
    if (kind == ArrayKind::kMixed) {  // full size, three quarters, half
      const int quarters = 4 - i % 3;
      camera.width = std::max(16, width * quarters / 4);
      camera.height = std::max(16, height * quarters / 4);
    }
    camera.intrinsics = Intrinsics(camera.width, camera.height);
  }
  switch (kind) {
    case ArrayKind::kArc:
      for (int i = 0; i < cameras; ++i) {
        const double angle = Spread(i, cameras, kArcStep, kMaxArc);
        const double radius = kTarget.z();
        const Eigen::Vector3d center(radius * std::sin(angle), 0, radius * (1 - std::cos(angle)));
        Place(result[i], LookingAt(center, kTarget), center);
      }
      break;
    case ArrayKind::kLine: {
      const Eigen::Matrix3d rotation = LookingAt(Eigen::Vector3d::Zero(), kTarget);
      for (int i = 0; i < cameras; ++i) {
        Place(result[i], rotation, Eigen::Vector3d(Spread(i, cameras, kLineStep_m, kMaxLine_m), 0, 0));
      }
      break;
    }
    case ArrayKind::kGrid:
      PlaceOnGrid(result);
      break;
    case ArrayKind::kIrregular:
    case ArrayKind::kMixed:
      PlaceIrregularly(result, seed);
      break;
  }
  return result;
}

}  // namespace depthfarm
