#include "common/scene/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "common/image/colour_conversion.h"
#include "common/scene/hash.h"

namespace depthfarm {
namespace {

using Eigen::Vector3d;

constexpr int kTile = 16;  // pixels a side; a ray is tried against the solids whose bounds touch its tile

// A solid as one camera sees it.
struct SeenShape {
  const Shape* shape = nullptr;
  Vector3d origin;  // the camera's centre in the solid's frame
  Eigen::Matrix3d
      local_from_pixel;  // direction of the ray of pixel (x, y, 1) in the solid's frame; its t is the depth z
};

struct Hit {
  const SeenShape* seen = nullptr;
  double depth = std::numeric_limits<double>::infinity();
};

struct PixelRect {  // inclusive
  int left = 0;
  int top = 0;
  int right = -1;
  int bottom = -1;
};

// Pixels that may show the solid: the bounds of its box, seen from the camera.
PixelRect PictureBounds(const Shape& shape, const Camera& camera) {
  const PixelRect whole{0, 0, camera.width - 1, camera.height - 1};
  if (shape.kind == Shape::Kind::kPlane) return whole;
  const Vector3d half = LocalBounds(shape);
  double left = std::numeric_limits<double>::infinity();
  double top = left;
  double right = -left;
  double bottom = -left;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d local((corner & 1) != 0 ? half.x() : -half.x(), (corner & 2) != 0 ? half.y() : -half.y(),
                         (corner & 4) != 0 ? half.z() : -half.z());
    const Vector3d world = shape.local_from_world.transpose() * local + shape.center;
    const Vector3d p = camera.intrinsics * (camera.cam_from_world_rotation * world + camera.cam_from_world_translation);
    if (p.z() < 1e-3) return whole;  // reaches behind the camera: no bounds to be had from corners
    left = std::min(left, p.x() / p.z());
    right = std::max(right, p.x() / p.z());
    top = std::min(top, p.y() / p.z());
    bottom = std::max(bottom, p.y() / p.z());
  }
  // One pixel more on each side: colour samples lie off the pixel centre.
  const auto inside = [](double value, int size) { return static_cast<int>(std::clamp(value, -1.0, size + 0.0)); };
  return {std::max(0, inside(std::floor(left) - 1, camera.width)),
          std::max(0, inside(std::floor(top) - 1, camera.height)),
          std::min(camera.width - 1, inside(std::ceil(right) + 1, camera.width)),
          std::min(camera.height - 1, inside(std::ceil(bottom) + 1, camera.height))};
}

Rgb Lit(const Rgb& colour, const Vector3d& normal) {
  static const Vector3d kKey = Vector3d(-0.45, -0.7, -0.55).normalized();  // directions towards the lamps
  static const Vector3d kFill = Vector3d(0.7, -0.25, -0.65).normalized();
  const double key = std::max(0.0, normal.dot(kKey));
  const double fill = std::max(0.0, normal.dot(kFill));
  return colour * (0.42 + 0.56 * key + 0.24 * fill);
}

class Renderer {
 public:
  Renderer(std::span<const Shape> shapes, std::span<const Material> materials, const Camera& camera)
      : materials_(materials),
        focal_px_(std::sqrt(camera.intrinsics(0, 0) * camera.intrinsics(1, 1))),
        tiles_across_((camera.width + kTile - 1) / kTile) {
    const Vector3d center = CenterInWorld(camera);
    const Eigen::Matrix3d world_from_pixel =
        camera.cam_from_world_rotation.transpose() * InverseIntrinsics(camera.intrinsics);
    const int tiles_down = (camera.height + kTile - 1) / kTile;
    tiles_.resize(static_cast<std::size_t>(tiles_across_) * static_cast<std::size_t>(tiles_down));
    for (const Shape& shape : shapes) {
      seen_.push_back(
          {&shape, shape.local_from_world * (center - shape.center), shape.local_from_world * world_from_pixel});
    }
    for (const SeenShape& seen : seen_) {
      const PixelRect bounds = PictureBounds(*seen.shape, camera);
      if (bounds.left > bounds.right || bounds.top > bounds.bottom) continue;
      for (int row = bounds.top / kTile; row <= bounds.bottom / kTile; ++row) {
        for (int column = bounds.left / kTile; column <= bounds.right / kTile; ++column) {
          tiles_[TileIndex(column, row)].push_back(&seen);
        }
      }
    }
  }

  // The nearest solid on the ray of position (x, y) within pixel (column, row).
  [[nodiscard]] Hit Trace(int column, int row, double x, double y) const {
    const Vector3d pixel(x, y, 1);
    Hit hit;
    for (const SeenShape* seen : tiles_[TileIndex(column / kTile, row / kTile)]) {
      const double depth = FirstHit(*seen->shape, seen->origin, seen->local_from_pixel * pixel);
      if (depth > 0 && depth < hit.depth) hit = {seen, depth};
    }
    return hit;
  }

  // Colour of what the ray of (x, y) meets; `sample_px` is the width of a colour sample.
  [[nodiscard]] Rgb Shade(const Hit& hit, double x, double y, double sample_px) const {
    if (hit.seen == nullptr) return Rgb::Zero();
    const Shape& shape = *hit.seen->shape;
    const Vector3d direction = hit.seen->local_from_pixel * Vector3d(x, y, 1);
    const Vector3d point = hit.seen->origin + hit.depth * direction;
    Vector3d normal = LocalNormal(shape, point);
    if (normal.dot(direction) > 0) normal = -normal;  // a plane seen from behind
    const double length = direction.norm();
    // Seen at a slant a pixel covers more of the surface; at grazing angles (rims of round things) it is left to blur.
    const double cosine = std::max(0.2, -normal.dot(direction) / length);
    const double footprint_m = sample_px * hit.depth * length / focal_px_ / cosine;
    const Rgb colour =
        MaterialColour(materials_[shape.material], point, SurfaceCoordinates(shape, point, normal), footprint_m);
    return Lit(colour, shape.local_from_world.transpose() * normal);
  }

 private:
  [[nodiscard]] std::size_t TileIndex(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_across_) + static_cast<std::size_t>(column);
  }

  std::span<const Material> materials_;
  double focal_px_;
  int tiles_across_;
  std::vector<SeenShape> seen_;
  std::vector<std::vector<const SeenShape*>> tiles_;
};

// A camera's own brightness and white balance: most of a deviation is common to the channels.
Rgb CameraGain(std::uint64_t camera_key, double deviation) {
  const std::uint64_t key = DerivedKey(camera_key, "gain");
  const NormalPair common = Normals(key, 0);
  const NormalPair others = Normals(key, 1);
  const Rgb own(common.second, others.first, others.second);
  return Rgb::Ones() + deviation * (common.first * Rgb::Ones() + 0.3 * own).cwiseMax(-2.5).cwiseMin(2.5);
}

}  // namespace

RenderedView RenderView(const Scene& scene, const Camera& camera, int frame, const RenderOptions& options) {
  const std::vector<Shape> shapes = ShapesAt(scene, frame);
  const Renderer renderer(shapes, scene.materials, camera);
  const std::uint64_t camera_key = DerivedKey(DerivedKey(scene.seed, "camera"), camera.name);
  const std::uint64_t noise_key = DerivedKey(DerivedKey(camera_key, "noise"), static_cast<std::uint64_t>(frame));
  const Rgb gain = CameraGain(camera_key, options.gain);
  const int samples = std::max(1, options.samples_per_side);
  const double sample_px = 1.0 / samples;

  RenderedView view{.rgb = RgbImage(camera.width, camera.height),
                    .depth = DepthMap(camera.width, camera.height),
                    .zones = ZoneMap(camera.width, camera.height)};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Hit hit = renderer.Trace(x, y, x, y);
      if (hit.seen != nullptr) {
        view.depth(x, y) = static_cast<float>(hit.depth);
        view.zones(x, y) = static_cast<std::uint8_t>(hit.seen->shape->zone);
      }
      Rgb sum = Rgb::Zero();
      for (int i = 0; i < samples * samples; ++i) {
        const double sx = x + (i % samples + 0.5) * sample_px - 0.5;
        const double sy = y + (i / samples + 0.5) * sample_px - 0.5;
        sum += renderer.Shade(renderer.Trace(x, y, sx, sy), sx, sy, sample_px);
      }
      Rgb colour = gain.cwiseProduct(sum / (samples * samples));
      if (options.noise > 0) {
        const std::uint64_t counter = 2 * view.rgb.Index(x, y);
        const NormalPair first = Normals(noise_key, counter);
        colour += options.noise * Rgb(first.first, first.second, Normals(noise_key, counter + 1).first);
      }
      view.rgb(x, y) = {RoundedToByte(colour[0]), RoundedToByte(colour[1]), RoundedToByte(colour[2])};
    }
  }
  return view;
}

YcbcrImage ToYcbcr(const RgbImage& rgb) {
  YcbcrImage result(rgb.width(), rgb.height());
  std::transform(rgb.values().begin(), rgb.values().end(), result.values().begin(),
                 [](const Rgb8& pixel) { return RoundedTo8Bit(Bt601FromRgb(pixel.r, pixel.g, pixel.b)); });
  return result;
}

}  // namespace depthfarm
