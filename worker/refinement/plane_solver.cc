#include "worker/refinement/plane_solver.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <vector>

#include "common/base/parallel.h"
#include "common/geometry/symmetric_solve.h"

namespace depthfarm {
namespace {

constexpr double kLambda = 70;          // weight of a link against squared colour differences in deviations
constexpr double kSlopeCoupling = 0.1;  // of a link's weight: equal slopes
constexpr double kColourScale = 10;     // grey levels
constexpr double kMaxStep = 1;          // pixels of u in a round
constexpr double kRidge = 1e-6;         // a segment without data or links stays where it is
constexpr int kSweeps = 12;
constexpr std::size_t kSegmentsAtOnce = 4096;  // of a thread

// (a, b, u at the centre).
using Local = std::array<double, 3>;

// A neighbour: 16 bytes, for the sweeps read all of them again and again and wait for memory, not for arithmetic.
struct Link {
  SegmentIndex other = 0;
  std::int16_t dx = 0;  // other's centre - own; sides are at most kMaxPictureSide
  std::int16_t dy = 0;
  double weight = 0;
};

// What a neighbour's plane adds to a segment's equations: its weight, times the way to its centre.
struct Terms {
  explicit Terms(const Link& link)
      : dx(link.dx),
        dy(link.dy),
        weight_dx(link.weight * dx),
        weight_dy(link.weight * dy),
        slope(link.weight * kSlopeCoupling * (dx * dx + dy * dy)) {}
  double dx;
  double dy;
  double weight_dx;
  double weight_dy;
  double slope;
};

// The segments that may move, ascending.
struct FreeSegments {
  static constexpr std::uint32_t kKept = std::numeric_limits<std::uint32_t>::max();

  explicit FreeSegments(std::span<const std::uint8_t> kept) : number_of(kept.size(), kKept) {
    for (SegmentIndex s = 0; s < kept.size(); ++s) {
      if (kept[s] != 0) continue;
      number_of[s] = static_cast<std::uint32_t>(all.size());
      all.push_back(s);
    }
  }
  std::vector<SegmentIndex> all;
  std::vector<std::uint32_t> number_of;  // by segment: its place in `all`, or kKept
};

// The links of each free segment, one after the other: those of the i-th are [first[i], first[i + 1]).
struct Links {
  std::vector<std::size_t> first;
  std::vector<Link> all;

  [[nodiscard]] std::span<const Link> Of(std::size_t i) const {
    return std::span(all).subspan(first[i], first[i + 1] - first[i]);
  }
};

// How far two planes are apart: each, extended to the other's centre (dx, dy) away, from that one; the mean.
double Gap(const Local& own, const Local& other, double dx, double dy) {
  const double there = own[2] + own[0] * dx + own[1] * dy - other[2];
  const double here = other[2] - other[0] * dx - other[1] * dy - own[2];
  return 0.5 * (std::abs(there) + std::abs(here));
}

Links LinksOf(const SegmentMap& map, const FreeSegments& free, std::span<const Local> start, double gap_scale) {
  constexpr std::uint32_t kKept = FreeSegments::kKept;
  Links links{.first = std::vector<std::size_t>(free.all.size() + 1), .all = {}};
  for (const auto& [s, t] : map.adjacency) {
    if (free.number_of[s] != kKept) ++links.first[free.number_of[s] + 1];
    if (free.number_of[t] != kKept) ++links.first[free.number_of[t] + 1];
  }
  std::partial_sum(links.first.begin(), links.first.end(), links.first.begin());
  links.all.resize(links.first.back());
  std::vector<std::size_t> next(links.first.begin(), links.first.end() - 1);
  for (const auto& [s, t] : map.adjacency) {
    const std::uint32_t number_of_s = free.number_of[s];
    const std::uint32_t number_of_t = free.number_of[t];
    if (number_of_s == kKept && number_of_t == kKept) continue;
    const int dx = map.centers[t].x - map.centers[s].x;
    const int dy = map.centers[t].y - map.centers[s].y;
    const double gap = Gap(start[s], start[t], dx, dy) / gap_scale;
    const double colour = static_cast<double>(L1Distance(map.means[s], map.means[t])) / kMeanColorScale;
    const double robust = 1 / (1 + gap * gap);
    const double weight = kLambda * robust * robust / (1 + colour / kColourScale);
    if (number_of_s != kKept)
      links.all[next[number_of_s]++] = {t, static_cast<std::int16_t>(dx), static_cast<std::int16_t>(dy), weight};
    if (number_of_t != kKept)
      links.all[next[number_of_t]++] = {s, static_cast<std::int16_t>(-dx), static_cast<std::int16_t>(-dy), weight};
  }
  return links;
}

// A segment's equations while its neighbours move: their left side stays.
struct Equations {
  SymmetricFactor factor;
  Local rhs{};  // of the data
};

Equations EquationsOf(const NormalEquations& data, const Local& start, std::span<const Link> links) {
  std::array<double, 6> h = data.h;
  Local r{};
  r[0] = data.rhs[0] + h[0] * start[0] + h[1] * start[1] + h[2] * start[2];
  r[1] = data.rhs[1] + h[1] * start[0] + h[3] * start[1] + h[4] * start[2];
  r[2] = data.rhs[2] + h[2] * start[0] + h[4] * start[1] + h[5] * start[2];
  constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
  for (std::size_t i = 0; i < 3; ++i) {
    h[kDiagonal[i]] += kRidge;
    r[i] += kRidge * start[i];
  }
  for (const Link& link : links) {
    // At the other's centre: (dx, dy, 1) . p = its u.
    const Terms terms(link);
    h[0] += terms.weight_dx * terms.dx + terms.slope;
    h[1] += terms.weight_dx * terms.dy;
    h[2] += terms.weight_dx;
    h[3] += terms.weight_dy * terms.dy + terms.slope;
    h[4] += terms.weight_dy;
    h[5] += 2 * link.weight;  // and at the own centre: u = the other's plane
  }
  return {SymmetricFactor(h), r};
}

Local RightSide(const Equations& equations, std::span<const Link> links, std::span<const Local> now) {
  Local r = equations.rhs;
  for (const Link& link : links) {
    const Local& q = now[link.other];
    const Terms terms(link);
    r[0] += terms.weight_dx * q[2] + terms.slope * q[0];
    r[1] += terms.weight_dy * q[2] + terms.slope * q[1];
    r[2] += link.weight * (2 * q[2] - q[0] * terms.dx - q[1] * terms.dy);
  }
  return r;
}

}  // namespace

void SolvePlanes(const SegmentMap& map, std::span<const NormalEquations> data, double gap_scale, RefinedView& view,
                 int threads) {
  const std::size_t n = view.num_segments();
  std::vector<SlantedPlane>& planes = view.planes;
  std::vector<Local> start(n);
  for (std::size_t s = 0; s < n; ++s)
    start[s] = {planes[s].a, planes[s].b, planes[s].At(map.centers[s].x, map.centers[s].y)};
  const FreeSegments free(view.kept);
  const Links links = LinksOf(map, free, start, gap_scale);
  std::vector<Equations> equations(free.all.size());
  ParallelForPieces(free.all.size(), kSegmentsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      equations[i] = EquationsOf(data[free.all[i]], start[free.all[i]], links.Of(i));
  });
  std::vector<Local> now = start;
  const auto update = [&](std::size_t i) {
    const SymmetricFactor& factor = equations[i].factor;
    if (!factor.definite()) return;
    const SegmentIndex s = free.all[i];
    Local solved = factor.Solve(RightSide(equations[i], links.Of(i), now));
    solved[2] = std::clamp(solved[2], start[s][2] - kMaxStep, start[s][2] + kMaxStep);
    now[s] = solved;
  };
  const std::size_t count = free.all.size();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < count; ++i) update(sweep % 2 == 0 ? i : count - 1 - i);
  }
  for (const SegmentIndex s : free.all) {
    const auto& [a, b, u] = now[s];
    planes[s] = {static_cast<float>(a), static_cast<float>(b),
                 static_cast<float>(u - a * map.centers[s].x - b * map.centers[s].y)};
  }
}

}  // namespace depthfarm
