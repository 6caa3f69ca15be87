#include "common/synthesis/surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/geometry/reprojection.h"

namespace depthfarm {
namespace {

// A step continues its line if the steps before and after it differ from it by at most this share of it.
constexpr float kStraightTolerance = 0.25F;

// Whether the step between values[1] and values[2] (1/z of four pixels in a row, 0 = none) is one of a straight line.
bool GoesOnStraight(float before, float from, float to, float after) {
  const float step = to - from;
  const float tolerance = kStraightTolerance * std::abs(step);
  return before > 0 && after > 0 && std::abs((from - before) - step) <= tolerance &&
         std::abs((after - to) - step) <= tolerance;
}

// One row; no branches, so that it can be vectorised.
void ProjectRow(const float* depth, int width, int y, const Reprojection& target_from_source, Surface& surface) {
  const Eigen::Matrix3d& m = target_from_source.m();
  const Eigen::Vector3d& e = target_from_source.e();
  const double row_x = m(0, 1) * y + m(0, 2);
  const double row_y = m(1, 1) * y + m(1, 2);
  const double row_z = m(2, 1) * y + m(2, 2);
  Surface::Point* points = surface.points.row(y);
  float* inverse_depth = surface.inverse_depth.row(y);
  float* parallax = surface.parallax.row(y);
  for (int x = 0; x < width; ++x) {
    const double inverse = 1.0 / static_cast<double>(depth[x] > 0 ? depth[x] : 1.0F);
    const double qz = m(2, 0) * x + row_z + e[2] * inverse;
    const bool seen = depth[x] > 0 && qz > 0;
    const double w = 1.0 / (seen ? qz : 1.0);
    const double px = (m(0, 0) * x + row_x + e[0] * inverse) * w;
    const double py = (m(1, 0) * x + row_y + e[1] * inverse) * w;
    const double dx = (e[0] - px * e[2]) * w;  // d px / d(1/z)
    const double dy = (e[1] - py * e[2]) * w;
    points[x] = {seen ? static_cast<float>(px) : 0.0F, seen ? static_cast<float>(py) : 0.0F,
                 seen ? static_cast<float>(inverse * w) : 0.0F};
    inverse_depth[x] = seen ? static_cast<float>(inverse) : 0.0F;
    parallax[x] = seen ? static_cast<float>(std::sqrt(dx * dx + dy * dy)) : 0.0F;
  }
}

void ProjectPoints(const DepthMap& depth, const Camera& source, const Camera& target, Surface& surface) {
  const Reprojection target_from_source(source, target);
  for (int y = 0; y < depth.height(); ++y) ProjectRow(depth.row(y), depth.width(), y, target_from_source, surface);
}

// Marks the tears between each pixel and the next one in direction (dx, dy), and the far sides of the jumps.
void MarkTears(int dx, int dy, std::uint8_t bit, const SurfaceParams& params, Surface& surface) {
  const Grid<float>& inverse = surface.inverse_depth;
  const float max_step = static_cast<float>(params.max_step_px);
  const float max_straight = static_cast<float>(params.max_straight_step_px);
  const auto at = [&](int x, int y) { return inverse.Contains(x, y) ? inverse(x, y) : 0.0F; };
  const std::ptrdiff_t to_next = dx + static_cast<std::ptrdiff_t>(dy) * inverse.width();
  for (int y = 0; y < inverse.height(); ++y) {
    const float* here = inverse.row(y);
    const float* parallax = surface.parallax.row(y);
    std::uint8_t* flags = surface.flags.row(y);
    const bool last_row = y + dy >= inverse.height();
    for (int x = 0; x < inverse.width(); ++x) {
      if (last_row || x + dx >= inverse.width() || !(here[x] > 0) || !(here[x + to_next] > 0)) {
        flags[x] |= bit;
        continue;
      }
      const float next = here[x + to_next];
      const float step = std::abs(next - here[x]) * std::max(parallax[x], parallax[x + to_next]);
      if (step <= max_step) continue;
      if (step <= max_straight && GoesOnStraight(at(x - dx, y - dy), here[x], next, at(x + 2 * dx, y + 2 * dy)))
        continue;
      flags[x] |= bit;
      flags[next < here[x] ? x + to_next : x] |= Surface::kBehindEdge;
    }
  }
}

// Pixels whose 4 x 4 surroundings, the reach of a cubic kernel, are one surface.
void MarkSmooth(Surface& surface) {
  Grid<std::uint8_t>& flags = surface.flags;
  const int width = flags.width();
  const int height = flags.height();
  // Torn anywhere between columns x - 1 .. x + 2 of a row (right) or in rows y, y + 1 (below): first along rows.
  Grid<std::uint8_t> row_torn(width, height, 1);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* f = flags.row(y);
    for (int x = 1; x + 2 < width; ++x) {
      const bool across = ((f[x - 1] | f[x] | f[x + 1]) & Surface::kTornRight) != 0;
      const bool down = ((f[x - 1] | f[x] | f[x + 1] | f[x + 2]) & Surface::kTornBelow) != 0;
      row_torn(x, y) = static_cast<std::uint8_t>((across ? 1 : 0) | (down ? 2 : 0));
    }
  }
  for (int y = 1; y + 2 < height; ++y) {
    for (int x = 1; x + 2 < width; ++x) {
      const int three = row_torn(x, y - 1) | row_torn(x, y) | row_torn(x, y + 1);
      if (three == 0 && (row_torn(x, y + 2) & 1) == 0) flags(x, y) |= Surface::kSmooth;
    }
  }
}

// Draws triangles and quads into a buffer of 1/z', the largest winning.
class ZBuffer {
 public:
  ZBuffer(int width, int height) : inverse_depth_(width, height, 0.0F) {}

  // Vertices in the order of a source pixel, its right and its lower neighbour; seen from behind it isn't drawn.
  void Draw(const Surface::Point& a, const Surface::Point& b, const Surface::Point& c) {
    const Triangle triangle(a, b, c);
    if (!(triangle.area > kMinArea)) return;
    ForEachPixel(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}),
                 std::max({a.y, b.y, c.y}), [&](int x, int y, float& inverse_depth) {
                   inverse_depth = std::max(inverse_depth, triangle.InverseDepth(x, y));
                 });
  }

  // The two triangles a, b, c and d, c, b of a quad a b / c d: as Draw of each, in one go.
  void DrawQuad(const Surface::Point& a, const Surface::Point& b, const Surface::Point& c, const Surface::Point& d) {
    const Triangle upper(a, b, c);
    ForEachPixel(std::min(std::min(a.x, b.x), std::min(c.x, d.x)), std::max(std::max(a.x, b.x), std::max(c.x, d.x)),
                 std::min(std::min(a.y, b.y), std::min(c.y, d.y)), std::max(std::max(a.y, b.y), std::max(c.y, d.y)),
                 [&](int x, int y, float& inverse_depth) {
                   float here = upper.InverseDepth(x, y);
                   if (here == 0) here = Triangle(d, c, b).InverseDepth(x, y);
                   inverse_depth = std::max(inverse_depth, here);
                 });
  }

  Grid<float> Take() && { return std::move(inverse_depth_); }

 private:
  static constexpr float kSlack = 1e-3F;    // float rounding must not open cracks between triangles
  static constexpr float kMinArea = 1e-4F;  // pixels^2

  struct Triangle {
    Triangle(const Surface::Point& a, const Surface::Point& b, const Surface::Point& c)
        : corner(a),
          ux(b.x - a.x),
          uy(b.y - a.y),
          vx(c.x - a.x),
          vy(c.y - a.y),
          du(b.inverse_depth - a.inverse_depth),
          dv(c.inverse_depth - a.inverse_depth),
          area(ux * vy - uy * vx) {}

    // 1/z' at a pixel; 0 outside, and anywhere in a triangle seen from behind or from the side.
    [[nodiscard]] float InverseDepth(int x, int y) const {
      const float px = static_cast<float>(x) - corner.x;
      const float py = static_cast<float>(y) - corner.y;
      const float u = px * vy - py * vx;  // times the area
      const float v = ux * py - uy * px;
      const float slack = kSlack * area;
      if (!(area > kMinArea && u >= -slack && v >= -slack && u + v <= area + slack)) return 0;
      return corner.inverse_depth + (u * du + v * dv) / area;
    }

    Surface::Point corner;
    float ux, uy, vx, vy;
    float du, dv;
    float area;  // twice, pixels^2
  };

  // The pixels of a box (with the slack) that the buffer has.
  template <typename Function>
  void ForEachPixel(float min_x, float max_x, float min_y, float max_y, const Function& function) {
    const float width = static_cast<float>(inverse_depth_.width());
    const float height = static_cast<float>(inverse_depth_.height());
    if (!(max_x >= 0 && max_y >= 0 && min_x <= width - 1 && min_y <= height - 1)) return;
    const int first_x = CeilOfPositive(std::max(min_x - kSlack, 0.0F));
    const int last_x = static_cast<int>(std::min(max_x + kSlack, width - 1));
    const int first_y = CeilOfPositive(std::max(min_y - kSlack, 0.0F));
    const int last_y = static_cast<int>(std::min(max_y + kSlack, height - 1));
    for (int y = first_y; y <= last_y; ++y) {
      float* row = inverse_depth_.row(y);
      for (int x = first_x; x <= last_x; ++x) function(x, y, row[x]);
    }
  }

  // std::ceil is a function call without SSE 4.1.
  static int CeilOfPositive(float value) {
    const int floor = static_cast<int>(value);
    return floor + (static_cast<float>(floor) < value ? 1 : 0);
  }

  Grid<float> inverse_depth_;
};

Surface::Point Sum(const Surface::Point& a, const Surface::Point& b, const Surface::Point& c) {
  return {a.x + b.x + c.x, a.y + b.y + c.y, a.inverse_depth + b.inverse_depth + c.inverse_depth};
}

Surface::Point Half(const Surface::Point& from, const Surface::Point& to, float sign) {
  const float s = 0.5F * sign;
  return {s * (to.x - from.x), s * (to.y - from.y), s * (to.inverse_depth - from.inverse_depth)};
}

// Half the way to the next pixel in direction (dx, dy) along this pixel's own surface. A pixel torn off on both sides
// keeps its own depth; its size in the target is then that of its source pixel.
Surface::Point HalfStep(const Surface& surface, int x, int y, int dx, int dy) {
  const std::uint8_t bit = dx != 0 ? Surface::kTornRight : Surface::kTornBelow;
  const Surface::Point& here = surface.points(x, y);
  if ((surface.flags(x, y) & bit) == 0) return Half(here, surface.points(x + dx, y + dy), 1);
  if (surface.flags.Contains(x - dx, y - dy) && (surface.flags(x - dx, y - dy) & bit) == 0) {
    return Half(here, surface.points(x - dx, y - dy), -1);
  }
  return {0.5F * static_cast<float>(dx), 0.5F * static_cast<float>(dy), 0};
}

void DrawSquare(const Surface& surface, int x, int y, ZBuffer& buffer) {
  const Surface::Point& centre = surface.points(x, y);
  const Surface::Point right = HalfStep(surface, x, y, 1, 0);
  const Surface::Point below = HalfStep(surface, x, y, 0, 1);
  const auto minus = [](const Surface::Point& p) { return Surface::Point{-p.x, -p.y, -p.inverse_depth}; };
  const Surface::Point top_left = Sum(centre, minus(right), minus(below));
  const Surface::Point top_right = Sum(centre, right, minus(below));
  const Surface::Point bottom_left = Sum(centre, minus(right), below);
  const Surface::Point bottom_right = Sum(centre, right, below);
  buffer.Draw(top_left, top_right, bottom_left);
  buffer.Draw(bottom_right, bottom_left, top_right);
}

// The triangles of the quad whose top-left pixel is (x, y): one for each corner connected to both its neighbours.
void DrawQuad(const Surface& surface, int x, int y, ZBuffer& buffer) {
  const bool top = (surface.flags(x, y) & Surface::kTornRight) == 0;
  const bool left = (surface.flags(x, y) & Surface::kTornBelow) == 0;
  const bool right = (surface.flags(x + 1, y) & Surface::kTornBelow) == 0;
  const bool bottom = (surface.flags(x, y + 1) & Surface::kTornRight) == 0;
  const Surface::Point& a = surface.points(x, y);
  const Surface::Point& b = surface.points(x + 1, y);
  const Surface::Point& c = surface.points(x, y + 1);
  const Surface::Point& d = surface.points(x + 1, y + 1);
  if (top && left && right && bottom) {
    buffer.DrawQuad(a, b, c, d);
    return;
  }
  if (top && left) buffer.Draw(a, b, c);
  if (right && bottom) buffer.Draw(d, c, b);
  if (top && right) buffer.Draw(b, d, a);
  if (left && bottom) buffer.Draw(c, a, d);
}

}  // namespace

Surface ProjectSurface(const DepthMap& depth, const Camera& source, const Camera& target, const SurfaceParams& params) {
  Surface surface;
  surface.points = Grid<Surface::Point>(depth.width(), depth.height());
  surface.inverse_depth = Grid<float>(depth.width(), depth.height());
  surface.parallax = Grid<float>(depth.width(), depth.height());
  surface.flags = Grid<std::uint8_t>(depth.width(), depth.height());
  ProjectPoints(depth, source, target, surface);
  MarkTears(1, 0, Surface::kTornRight, params, surface);
  MarkTears(0, 1, Surface::kTornBelow, params, surface);
  MarkSmooth(surface);
  return surface;
}

Grid<float> RenderInverseDepth(const Surface& surface, int width, int height) {
  ZBuffer buffer(width, height);
  const int last_x = surface.flags.width() - 1;
  const int last_y = surface.flags.height() - 1;
  for (int y = 0; y <= last_y; ++y) {
    for (int x = 0; x <= last_x; ++x) {
      if (x < last_x && y < last_y) DrawQuad(surface, x, y, buffer);
      if (surface.inverse_depth(x, y) == 0) continue;
      const std::uint8_t own = surface.flags(x, y);
      const bool torn = (own & (Surface::kTornRight | Surface::kTornBelow)) != 0 || x == 0 || y == 0 ||
                        (surface.flags(x - 1, y) & Surface::kTornRight) != 0 ||
                        (surface.flags(x, y - 1) & Surface::kTornBelow) != 0;
      if (torn) DrawSquare(surface, x, y, buffer);
    }
  }
  return std::move(buffer).Take();
}

}  // namespace depthfarm
