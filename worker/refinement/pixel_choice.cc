#include "worker/refinement/pixel_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace depthfarm {
namespace {

constexpr double kJump = 0.5;       // pixels of u between neighbours: a depth jump
constexpr double kHighestJump = 8;  // the bound is raised to find fewer, but not beyond
constexpr double kMaxBand = 0.25;   // of the picture, before the bound is raised
constexpr int kBand = 4;            // pixels to either side of a jump
constexpr int kReach = 5;           // candidates come from as far
constexpr double kDistinct = 0.15;  // pixels of u between candidates
constexpr std::size_t kMaxCandidates = 5;
constexpr int kSweeps = 3;
constexpr double kPairCost = 0.05;     // of rho, for neighbours on different surfaces
constexpr double kPairScale = 0.5;     // pixels of u at which they are that
constexpr double kUnseen = 0.5;        // rho of what no other view sees
constexpr double kColourFalloff = 40;  // grey levels, summed over Y, Cb, Cr

constexpr std::array<std::pair<int, int>, 4> kFourNeighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
constexpr std::array<std::pair<int, int>, 8> kEightDirections{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};

Grid<std::uint8_t> PixelsNearJumps(const InverseDepthMap& map, double jump) {
  Grid<std::uint8_t> band(map.width(), map.height());
  const auto mark = [&](int x0, int y0) {
    for (int y = std::max(0, y0 - kBand); y <= std::min(map.height() - 1, y0 + kBand); ++y)
      for (int x = std::max(0, x0 - kBand); x <= std::min(map.width() - 1, x0 + kBand); ++x) band(x, y) = 1;
  };
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if ((x + 1 < map.width() && std::abs(map(x, y) - map(x + 1, y)) > jump) ||
          (y + 1 < map.height() && std::abs(map(x, y) - map(x, y + 1)) > jump))
        mark(x, y);
    }
  }
  return band;
}

Grid<std::uint8_t> JumpBand(const InverseDepthMap& map) {
  for (double jump = kJump;; jump *= 2) {
    Grid<std::uint8_t> band = PixelsNearJumps(map, jump);
    const auto marked = std::count(band.values().begin(), band.values().end(), 1);
    if (2 * jump > kHighestJump || static_cast<double>(marked) <= kMaxBand * static_cast<double>(band.size()))
      return band;
  }
}

// About exp(-d / 10), without the library's exp, whose last bits differ between machines: (1 + d / 40)^-4.
double ColourWeight(const Colour& a, const Colour& b) {
  double d = 0;
  for (int i = 0; i < 3; ++i) d += std::abs(a[i] - b[i]);
  const double base = 1 / (1 + d / kColourFalloff);
  return base * base * base * base;
}

// The planes that one pixel may take.
struct Choice {
  int x = 0;
  int y = 0;
  std::array<PlaneIndex, kMaxCandidates> planes{};
  std::array<double, kMaxCandidates> costs{};
  std::size_t count = 0;
};

// Mean misfit of the 3 x 3 pixels around, over the better half of the other views: an occluder hides a pixel from some.
double PatchCost(const ColourGrid& own, std::span<const OtherView> others, const SlantedPlane& plane, int x0, int y0) {
  std::vector<double> per_view;
  for (const OtherView& other : others) {
    double sum = 0;
    double weights = 0;
    for (int y = std::max(0, y0 - 1); y <= std::min(own.height() - 1, y0 + 1); ++y) {
      for (int x = std::max(0, x0 - 1); x <= std::min(own.width() - 1, x0 + 1); ++x) {
        const auto rho = Misfit(own(x, y), other, x, y, plane.At(x, y));
        if (!rho) continue;
        const double w = ColourWeight(own(x, y), own(x0, y0));
        sum += w * *rho;
        weights += w;
      }
    }
    if (weights > 0) per_view.push_back(sum / weights);
  }
  if (per_view.empty()) return kUnseen;
  std::sort(per_view.begin(), per_view.end());
  const std::size_t half = (per_view.size() + 1) / 2;
  double sum = 0;
  for (std::size_t i = 0; i < half; ++i) sum += per_view[i];
  return sum / static_cast<double>(half);
}

Choice CandidatesAt(const RefinedView& view, int x, int y) {
  Choice choice{.x = x, .y = y};
  std::array<double, kMaxCandidates> values{};
  const auto offer = [&](int px, int py) {
    if (!view.plane_of_pixel.Contains(px, py) || choice.count == kMaxCandidates) return;
    const PlaneIndex plane = view.plane_of_pixel(px, py);
    const double u = view.planes[plane].At(x, y);
    for (std::size_t i = 0; i < choice.count; ++i)
      if (std::abs(values[i] - u) <= kDistinct) return;
    values[choice.count] = u;
    choice.planes[choice.count++] = plane;
  };
  offer(x, y);
  for (int d = 1; d <= kReach; ++d)
    for (const auto& [dx, dy] : kEightDirections) offer(x + d * dx, y + d * dy);
  return choice;
}

PlaneIndex BestPlane(const ColourGrid& own, const RefinedView& view, const Choice& choice) {
  double best = std::numeric_limits<double>::infinity();
  PlaneIndex chosen = choice.planes[0];
  for (std::size_t i = 0; i < choice.count; ++i) {
    double cost = choice.costs[i];
    const double u = view.planes[choice.planes[i]].At(choice.x, choice.y);
    for (const auto& [dx, dy] : kFourNeighbours) {
      const int nx = choice.x + dx;
      const int ny = choice.y + dy;
      if (!view.plane_of_pixel.Contains(nx, ny)) continue;
      const double gap = std::abs(view.At(nx, ny) - u);
      cost += kPairCost * std::min(1.0, gap / kPairScale) * ColourWeight(own(choice.x, choice.y), own(nx, ny));
    }
    if (cost < best) {
      best = cost;
      chosen = choice.planes[i];
    }
  }
  return chosen;
}

}  // namespace

void ChoosePlanes(const ColourGrid& own, const Grid<SegmentIndex>& segments, std::span<const OtherView> others,
                  RefinedView& view, const std::stop_token& stop) {
  const Grid<std::uint8_t> band = JumpBand(view.Map());
  std::vector<Choice> choices;
  for (int y = 0; y < band.height() && !stop.stop_requested(); ++y) {
    for (int x = 0; x < band.width(); ++x) {
      if (band(x, y) == 0 || view.kept[segments(x, y)] != 0) continue;
      Choice choice = CandidatesAt(view, x, y);
      if (choice.count < 2) continue;
      for (std::size_t i = 0; i < choice.count; ++i)
        choice.costs[i] = PatchCost(own, others, view.planes[choice.planes[i]], x, y);
      choices.push_back(choice);
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (const Choice& choice : choices) view.plane_of_pixel(choice.x, choice.y) = BestPlane(own, view, choice);
}

}  // namespace depthfarm
