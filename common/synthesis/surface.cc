#include "common/synthesis/surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

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
  float* target_x = surface.x.row(y);
  float* target_y = surface.y.row(y);
  float* target_inverse_depth = surface.target_inverse_depth.row(y);
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
    target_x[x] = seen ? static_cast<float>(px) : 0.0F;
    target_y[x] = seen ? static_cast<float>(py) : 0.0F;
    target_inverse_depth[x] = seen ? static_cast<float>(inverse * w) : 0.0F;
    inverse_depth[x] = seen ? static_cast<float>(inverse) : 0.0F;
    parallax[x] = seen ? std::sqrt(static_cast<float>(dx * dx + dy * dy)) : 0.0F;
  }
}

void ProjectPoints(const DepthMap& depth, const Camera& source, const Camera& target, Surface& surface) {
  const Reprojection target_from_source(source, target);
  for (int y = 0; y < depth.height(); ++y) ProjectRow(depth.row(y), depth.width(), y, target_from_source, surface);
}

// Whether each pixel of a row may be torn from the next one: one of them is unknown or the step between them is long.
// No branches, so that it is vectorised; almost all pixels need no closer look.
void FindLongSteps(const float* here, const float* next, const float* parallax, const float* next_parallax,
                   float max_step, std::vector<std::uint8_t>& is_long) {
  std::uint8_t* const out = is_long.data();
  const auto count = static_cast<int>(is_long.size());
  for (int x = 0; x < count; ++x) {
    const float step = std::abs(next[x] - here[x]) * std::max(parallax[x], next_parallax[x]);
    out[x] = static_cast<std::uint8_t>(
        (static_cast<int>(here[x] > 0) & static_cast<int>(next[x] > 0) & static_cast<int>(step <= max_step)) ^ 1);
  }
}

// Marks the tears between each pixel and the next one in direction (dx, dy), and the far sides of the jumps.
void MarkTears(int dx, int dy, std::uint8_t bit, const SurfaceParams& params, Surface& surface) {
  const Grid<float>& inverse = surface.inverse_depth;
  const float max_step = static_cast<float>(params.max_step_px);
  const float max_straight = static_cast<float>(params.max_straight_step_px);
  const auto at = [&](int x, int y) { return inverse.Contains(x, y) ? inverse(x, y) : 0.0F; };
  const std::ptrdiff_t to_next = dx + static_cast<std::ptrdiff_t>(dy) * inverse.width();
  const int end_x = inverse.width() - dx;
  const int end_y = inverse.height() - dy;
  std::vector<std::uint8_t> is_long(static_cast<std::size_t>(end_x));
  for (int y = 0; y < inverse.height(); ++y) {
    const float* here = inverse.row(y);
    const float* parallax = surface.parallax.row(y);
    std::uint8_t* flags = surface.flags.row(y);
    const int end = y < end_y ? end_x : 0;
    for (int x = end; x < inverse.width(); ++x) flags[x] |= bit;
    if (end == 0) continue;
    FindLongSteps(here, here + to_next, parallax, parallax + to_next, max_step, is_long);
    for (int x = 0; x < end; ++x) {
      if (is_long[static_cast<std::size_t>(x)] == 0) continue;
      const float next = here[x + to_next];
      if (!(here[x] > 0) || !(next > 0)) {
        flags[x] |= bit;
        continue;
      }
      const float step = std::abs(next - here[x]) * std::max(parallax[x], parallax[x + to_next]);
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

// A corner of what is drawn.
struct Point {
  float x = 0;  // pixel of the target
  float y = 0;
  float inverse_depth = 0;
};

Point PointAt(const Surface& surface, int x, int y) {
  return {surface.x(x, y), surface.y(x, y), surface.target_inverse_depth(x, y)};
}

// Pixels of the target, both ends included; none if the last is before the first.
struct Box {
  int first_x = 0;
  int last_x = -1;
  int first_y = 0;
  int last_y = -1;
};

constexpr float kSlack = 1e-3F;    // float rounding must not open cracks between triangles
constexpr float kMinArea = 1e-4F;  // pixels^2

// First and last of `size` pixels in [low, high] and the slack around it. Without std::ceil and std::floor, which are
// function calls before SSE 4.1.
int FirstPixel(float low, int size) {
  const float from = std::min(std::max(low - kSlack, 0.0F), static_cast<float>(size));
  const int whole = static_cast<int>(from);
  return whole + (static_cast<float>(whole) < from ? 1 : 0);
}
int LastPixel(float high, int size) {
  return static_cast<int>(std::max(std::min(high + kSlack, static_cast<float>(size - 1)) + 1, 0.0F)) - 1;
}

// Draws triangles and quads into a buffer of 1/z', the largest winning. Corners in the order of a source pixel, its
// right and its lower neighbour; seen from behind they aren't drawn.
class ZBuffer {
 public:
  ZBuffer(int width, int height) : inverse_depth_(width, height, 0.0F) {}

  void Draw(const Point& a, const Point& b, const Point& c) {
    const Triangle triangle(a, b, c);
    if (!(triangle.area > kMinArea)) return;
    const int width = inverse_depth_.width();
    const int height = inverse_depth_.height();
    const Box box = {FirstPixel(std::min({a.x, b.x, c.x}), width), LastPixel(std::max({a.x, b.x, c.x}), width),
                     FirstPixel(std::min({a.y, b.y, c.y}), height), LastPixel(std::max({a.y, b.y, c.y}), height)};
    ForEachPixel(box, [&](int x, int y, float& inverse_depth) {
      inverse_depth = std::max(inverse_depth, triangle.InverseDepth(x, y));
    });
  }

  // The two triangles a, b, c and d, c, b of a quad a b / c d: as Draw of each, in one go. `box`: around all four.
  void DrawQuad(const Point& a, const Point& b, const Point& c, const Point& d, const Box& box) {
    const Triangle upper(a, b, c);
    ForEachPixel(box, [&](int x, int y, float& inverse_depth) {
      float here = upper.InverseDepth(x, y);
      if (here == 0) here = Triangle(d, c, b).InverseDepth(x, y);
      inverse_depth = std::max(inverse_depth, here);
    });
  }

  Grid<float> Take() && { return std::move(inverse_depth_); }

 private:
  struct Triangle {
    Triangle(const Point& a, const Point& b, const Point& c)
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

    Point corner;
    float ux, uy, vx, vy;
    float du, dv;
    float area;  // twice, pixels^2
  };

  template <typename Function>
  void ForEachPixel(const Box& box, const Function& function) {
    for (int y = box.first_y; y <= box.last_y; ++y) {
      float* row = inverse_depth_.row(y);
      for (int x = box.first_x; x <= box.last_x; ++x) function(x, y, row[x]);
    }
  }

  Grid<float> inverse_depth_;
};

// The boxes of all quads between two rows of the source. Structures of arrays and plain loops: they are vectorised, and
// most of the quads of a picture that shrinks or keeps its size hold one pixel or none.
class QuadBoxes {
 public:
  QuadBoxes(int quads, int target_width, int target_height)
      : width_(target_width), height_(target_height), along_x_(quads), along_y_(quads) {}

  void Find(const Surface& surface, int y) {
    along_x_.Find(surface.x.row(y), surface.x.row(y + 1), width_);
    along_y_.Find(surface.y.row(y), surface.y.row(y + 1), height_);
  }
  [[nodiscard]] bool Empty(std::size_t i) const {
    return along_x_.last[i] < along_x_.first[i] || along_y_.last[i] < along_y_.first[i];
  }
  [[nodiscard]] Box At(std::size_t i) const {
    return {along_x_.first[i], along_x_.last[i], along_y_.first[i], along_y_.last[i]};
  }

 private:
  struct Spans {
    explicit Spans(int quads) : first(static_cast<std::size_t>(quads)), last(static_cast<std::size_t>(quads)) {}

    // Of the quads whose corners lie at upper[i], upper[i + 1], lower[i], lower[i + 1].
    void Find(const float* upper, const float* lower, int size) {
      int* const firsts = first.data();
      int* const lasts = last.data();
      const auto count = static_cast<int>(first.size());
      for (int i = 0; i < count; ++i) {
        const float low = std::min(std::min(upper[i], upper[i + 1]), std::min(lower[i], lower[i + 1]));
        const float high = std::max(std::max(upper[i], upper[i + 1]), std::max(lower[i], lower[i + 1]));
        firsts[i] = FirstPixel(low, size);
        lasts[i] = LastPixel(high, size);
      }
    }

    std::vector<int> first;
    std::vector<int> last;
  };

  int width_;
  int height_;
  Spans along_x_;
  Spans along_y_;
};

Point Sum(const Point& a, const Point& b, const Point& c) {
  return {a.x + b.x + c.x, a.y + b.y + c.y, a.inverse_depth + b.inverse_depth + c.inverse_depth};
}

Point Half(const Point& from, const Point& to, float sign) {
  const float s = 0.5F * sign;
  return {s * (to.x - from.x), s * (to.y - from.y), s * (to.inverse_depth - from.inverse_depth)};
}

// Half the way to the next pixel in direction (dx, dy) along this pixel's own surface. A pixel torn off on both sides
// keeps its own depth; its size in the target is then that of its source pixel.
Point HalfStep(const Surface& surface, int x, int y, int dx, int dy) {
  const std::uint8_t bit = dx != 0 ? Surface::kTornRight : Surface::kTornBelow;
  const Point here = PointAt(surface, x, y);
  if ((surface.flags(x, y) & bit) == 0) return Half(here, PointAt(surface, x + dx, y + dy), 1);
  if (surface.flags.Contains(x - dx, y - dy) && (surface.flags(x - dx, y - dy) & bit) == 0) {
    return Half(here, PointAt(surface, x - dx, y - dy), -1);
  }
  return {0.5F * static_cast<float>(dx), 0.5F * static_cast<float>(dy), 0};
}

void DrawSquare(const Surface& surface, int x, int y, ZBuffer& buffer) {
  const Point centre = PointAt(surface, x, y);
  const Point right = HalfStep(surface, x, y, 1, 0);
  const Point below = HalfStep(surface, x, y, 0, 1);
  const auto minus = [](const Point& p) { return Point{-p.x, -p.y, -p.inverse_depth}; };
  const Point top_left = Sum(centre, minus(right), minus(below));
  const Point top_right = Sum(centre, right, minus(below));
  const Point bottom_left = Sum(centre, minus(right), below);
  const Point bottom_right = Sum(centre, right, below);
  buffer.Draw(top_left, top_right, bottom_left);
  buffer.Draw(bottom_right, bottom_left, top_right);
}

// The triangles of the quad whose top-left pixel is (x, y): one for each corner connected to both its neighbours.
void DrawQuad(const Surface& surface, int x, int y, const Box& box, ZBuffer& buffer) {
  const bool top = (surface.flags(x, y) & Surface::kTornRight) == 0;
  const bool left = (surface.flags(x, y) & Surface::kTornBelow) == 0;
  const bool right = (surface.flags(x + 1, y) & Surface::kTornBelow) == 0;
  const bool bottom = (surface.flags(x, y + 1) & Surface::kTornRight) == 0;
  const Point a = PointAt(surface, x, y);
  const Point b = PointAt(surface, x + 1, y);
  const Point c = PointAt(surface, x, y + 1);
  const Point d = PointAt(surface, x + 1, y + 1);
  if (top && left && right && bottom) {
    buffer.DrawQuad(a, b, c, d, box);
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
  surface.x = Grid<float>(depth.width(), depth.height());
  surface.y = Grid<float>(depth.width(), depth.height());
  surface.target_inverse_depth = Grid<float>(depth.width(), depth.height());
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
  QuadBoxes boxes(last_x, width, height);
  for (int y = 0; y <= last_y; ++y) {
    if (y < last_y) boxes.Find(surface, y);
    for (int x = 0; x <= last_x; ++x) {
      const auto quad = static_cast<std::size_t>(x);
      if (x < last_x && y < last_y && !boxes.Empty(quad)) DrawQuad(surface, x, y, boxes.At(quad), buffer);
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
