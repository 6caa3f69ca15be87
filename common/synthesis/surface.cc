#include "common/synthesis/surface.h"

#include <algorithm>
#include <cmath>

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

void ProjectPoints(const DepthMap& depth, const Camera& source, const Camera& target, Surface& surface) {
  const Reprojection target_from_source(source, target);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const float z = depth(x, y);
      if (!(z > 0)) continue;
      const double inverse = 1.0 / static_cast<double>(z);
      const Reprojection::Projected p = target_from_source.Project(x, y, inverse);
      if (!(p.depth_per_source > 0)) continue;
      const double step = 0.01 * inverse;
      const Reprojection::Projected moved = target_from_source.Project(x, y, inverse + step);
      surface.inverse_depth(x, y) = static_cast<float>(inverse);
      surface.points(x, y) = {static_cast<float>(p.x), static_cast<float>(p.y),
                              static_cast<float>(inverse / p.depth_per_source)};
      const double dx = moved.x - p.x;
      const double dy = moved.y - p.y;
      surface.parallax(x, y) = static_cast<float>(std::sqrt(dx * dx + dy * dy) / step);
    }
  }
}

// Marks the tears between each pixel and the next one in direction (dx, dy), and the far sides of the jumps.
void MarkTears(int dx, int dy, std::uint8_t bit, const SurfaceParams& params, Surface& surface) {
  const Grid<float>& inverse = surface.inverse_depth;
  const float max_step = static_cast<float>(params.max_step_px);
  const float max_straight = static_cast<float>(params.max_straight_step_px);
  const auto at = [&](int x, int y) { return inverse.Contains(x, y) ? inverse(x, y) : 0.0F; };
  for (int y = 0; y < inverse.height(); ++y) {
    for (int x = 0; x < inverse.width(); ++x) {
      const float here = inverse(x, y);
      const float next = at(x + dx, y + dy);
      bool torn = !(here > 0) || !(next > 0);
      if (!torn) {
        const float parallax = std::max(surface.parallax(x, y), surface.parallax(x + dx, y + dy));
        const float step = std::abs(next - here) * parallax;
        torn = step > max_step &&
               (step > max_straight || !GoesOnStraight(at(x - dx, y - dy), here, next, at(x + 2 * dx, y + 2 * dy)));
        if (torn) {
          (next < here ? surface.flags(x + dx, y + dy) : surface.flags(x, y)) |= Surface::kBehindEdge;
        }
      }
      if (torn) surface.flags(x, y) |= bit;
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

// Draws triangles into a buffer of 1/z', the largest winning.
class ZBuffer {
 public:
  ZBuffer(int width, int height) : inverse_depth_(width, height, 0.0F) {}

  // Vertices in the order of a source pixel, its right and its lower neighbour; seen from behind it isn't drawn.
  void Draw(const Surface::Point& a, const Surface::Point& b, const Surface::Point& c) {
    const float min_y = std::min({a.y, b.y, c.y});
    const float max_y = std::max({a.y, b.y, c.y});
    const float min_x = std::min({a.x, b.x, c.x});
    const float max_x = std::max({a.x, b.x, c.x});
    const float width = static_cast<float>(inverse_depth_.width());
    const float height = static_cast<float>(inverse_depth_.height());
    if (!(max_x >= 0 && max_y >= 0 && min_x <= width - 1 && min_y <= height - 1)) return;
    const int first_x = static_cast<int>(std::ceil(std::max(min_x - kSlack, 0.0F)));
    const int last_x = static_cast<int>(std::min(max_x + kSlack, width - 1));
    const int first_y = static_cast<int>(std::ceil(std::max(min_y - kSlack, 0.0F)));
    const int last_y = static_cast<int>(std::min(max_y + kSlack, height - 1));
    if (first_x > last_x || first_y > last_y) return;
    const float ux = b.x - a.x, uy = b.y - a.y;
    const float vx = c.x - a.x, vy = c.y - a.y;
    const float area = ux * vy - uy * vx;
    if (!(area > kMinArea)) return;
    const float scale = 1.0F / area;
    const float du = b.inverse_depth - a.inverse_depth;
    const float dv = c.inverse_depth - a.inverse_depth;
    for (int y = first_y; y <= last_y; ++y) {
      float* row = inverse_depth_.row(y);
      const float py = static_cast<float>(y) - a.y;
      for (int x = first_x; x <= last_x; ++x) {
        const float px = static_cast<float>(x) - a.x;
        const float u = (px * vy - py * vx) * scale;
        const float v = (ux * py - uy * px) * scale;
        if (u < -kSlack || v < -kSlack || u + v > 1.0F + kSlack) continue;
        row[x] = std::max(row[x], a.inverse_depth + u * du + v * dv);
      }
    }
  }

  Grid<float> Take() && { return std::move(inverse_depth_); }

 private:
  static constexpr float kSlack = 1e-3F;    // float rounding must not open cracks between triangles
  static constexpr float kMinArea = 1e-4F;  // pixels^2

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
  if (top && left) buffer.Draw(a, b, c);
  if (right && bottom) buffer.Draw(d, c, b);
  if (top && left && right && bottom) return;  // the two above cover the quad
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
