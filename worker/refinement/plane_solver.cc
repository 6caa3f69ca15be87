#include "worker/refinement/plane_solver.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "common/geometry/symmetric_solve.h"

namespace depthfarm {
namespace {

constexpr double kLambda = 70;          // weight of a link against squared colour differences in deviations
constexpr double kSlopeCoupling = 0.1;  // of a link's weight: equal slopes
constexpr double kColourScale = 10;     // grey levels
constexpr double kMaxStep = 1;          // pixels of u in a round
constexpr double kRidge = 1e-6;         // a segment without data or links stays where it is
constexpr int kSweeps = 12;

struct Link {
  std::size_t other = 0;
  double dx = 0;  // other's centre - own
  double dy = 0;
  double weight = 0;
};

// (a, b, u at the centre).
using Local = std::array<double, 3>;

std::vector<std::vector<Link>> LinksOf(const SegmentMap& map, std::span<const Local> start, double gap_scale) {
  std::vector<std::vector<Link>> links(start.size());
  for (const auto& [s, t] : map.adjacency) {
    const double dx = map.centers[t].x - map.centers[s].x;
    const double dy = map.centers[t].y - map.centers[s].y;
    const double gap_t = start[s][2] + start[s][0] * dx + start[s][1] * dy - start[t][2];
    const double gap_s = start[t][2] - start[t][0] * dx - start[t][1] * dy - start[s][2];
    const double gap = 0.5 * (std::abs(gap_t) + std::abs(gap_s)) / gap_scale;
    const double colour = static_cast<double>(L1Distance(map.means[s], map.means[t])) / kMeanColorScale;
    const double robust = 1 / (1 + gap * gap);
    const double weight = kLambda * robust * robust / (1 + colour / kColourScale);
    links[s].push_back({t, dx, dy, weight});
    links[t].push_back({s, -dx, -dy, weight});
  }
  return links;
}

}  // namespace

void SolvePlanes(const SegmentMap& map, std::span<const NormalEquations> data, double gap_scale, RefinedView& view) {
  const std::size_t n = view.num_segments();
  std::vector<SlantedPlane>& planes = view.planes;
  std::vector<Local> start(n);
  for (std::size_t s = 0; s < n; ++s)
    start[s] = {planes[s].a, planes[s].b, planes[s].At(map.centers[s].x, map.centers[s].y)};
  const std::vector<std::vector<Link>> links = LinksOf(map, start, gap_scale);
  std::vector<Local> now = start;
  const auto update = [&](std::size_t s) {
    if (view.kept[s] != 0) return;
    std::array<double, 6> h = data[s].h;
    Local r{};
    const Local& p = start[s];
    r[0] = data[s].rhs[0] + h[0] * p[0] + h[1] * p[1] + h[2] * p[2];
    r[1] = data[s].rhs[1] + h[1] * p[0] + h[3] * p[1] + h[4] * p[2];
    r[2] = data[s].rhs[2] + h[2] * p[0] + h[4] * p[1] + h[5] * p[2];
    constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
    for (std::size_t i = 0; i < 3; ++i) {
      h[kDiagonal[i]] += kRidge;
      r[i] += kRidge * p[i];
    }
    for (const Link& link : links[s]) {
      const Local& q = now[link.other];
      const double w = link.weight;
      // At the other's centre: (dx, dy, 1) . p = q[2].
      h[0] += w * link.dx * link.dx;
      h[1] += w * link.dx * link.dy;
      h[2] += w * link.dx;
      h[3] += w * link.dy * link.dy;
      h[4] += w * link.dy;
      h[5] += w;
      r[0] += w * link.dx * q[2];
      r[1] += w * link.dy * q[2];
      r[2] += w * q[2];
      // At the own centre: p[2] = q extended.
      h[5] += w;
      r[2] += w * (q[2] - q[0] * link.dx - q[1] * link.dy);
      const double slope = w * kSlopeCoupling * (link.dx * link.dx + link.dy * link.dy);
      h[0] += slope;
      h[3] += slope;
      r[0] += slope * q[0];
      r[1] += slope * q[1];
    }
    Local solved{};
    if (!SolveSymmetric(h, r, solved)) return;
    solved[2] = std::clamp(solved[2], p[2] - kMaxStep, p[2] + kMaxStep);
    now[s] = solved;
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < n; ++i) update(sweep % 2 == 0 ? i : n - 1 - i);
  }
  for (std::size_t s = 0; s < n; ++s) {
    if (view.kept[s] != 0) continue;  // its bits too
    const auto& [a, b, u] = now[s];
    planes[s] = {static_cast<float>(a), static_cast<float>(b),
                 static_cast<float>(u - a * map.centers[s].x - b * map.centers[s].y)};
  }
}

}  // namespace depthfarm
