#include "worker/refinement/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <utility>

#include "worker/refinement/data_term.h"
#include "worker/refinement/plane_solver.h"

namespace depthfarm {
namespace {

constexpr double kJump = 0.5;       // pixels of u between neighbours: a depth jump
constexpr int kBand = 4;            // pixels to either side of it
constexpr int kReach = 5;           // candidates come from as far
constexpr double kDistinct = 0.15;  // pixels of u between candidates
constexpr std::size_t kMaxCandidates = 5;
constexpr double kPairCost = 0.05;

InverseDepthMap MapOf(const RefinedView& view) {
  const auto& segments = view.segment_of_pixel;
  InverseDepthMap map(segments.width(), segments.height());
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) map(x, y) = static_cast<float>(view.planes[segments(x, y)].At(x, y));
  return map;
}

Grid<std::uint8_t> JumpBand(const InverseDepthMap& map) {
  Grid<std::uint8_t> band(map.width(), map.height());
  const auto mark = [&](int x0, int y0) {
    for (int y = std::max(0, y0 - kBand); y <= std::min(map.height() - 1, y0 + kBand); ++y)
      for (int x = std::max(0, x0 - kBand); x <= std::min(map.width() - 1, x0 + kBand); ++x) band(x, y) = 1;
  };
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if ((x + 1 < map.width() && std::abs(map(x, y) - map(x + 1, y)) > kJump) ||
          (y + 1 < map.height() && std::abs(map(x, y) - map(x, y + 1)) > kJump))
        mark(x, y);
    }
  }
  return band;
}

// exp(-d / 10) without the library's exp, whose last bits differ between machines: (1 + d / 40)^-4.
double ColourWeight(const Colour& a, const Colour& b) {
  double d = 0;
  for (int i = 0; i < 3; ++i) d += std::abs(a[i] - b[i]);
  const double base = 1 / (1 + d / 40);
  return base * base * base * base;
}

struct Choice {
  int x = 0;
  int y = 0;
  std::array<SegmentIndex, kMaxCandidates> segments{};
  std::array<double, kMaxCandidates> costs{};
  std::size_t count = 0;
};

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
  if (per_view.empty()) return 0.5;
  std::sort(per_view.begin(), per_view.end());
  const std::size_t half = (per_view.size() + 1) / 2;
  double sum = 0;
  for (std::size_t i = 0; i < half; ++i) sum += per_view[i];
  return sum / static_cast<double>(half);
}

void ChoosePlanes(const ColourGrid& own, std::span<const OtherView> others, RefinedView& view) {
  const InverseDepthMap map = MapOf(view);
  const Grid<std::uint8_t> band = JumpBand(map);
  std::vector<Choice> choices;
  Grid<SegmentIndex>& segments = view.segment_of_pixel;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (band(x, y) == 0) continue;
      Choice choice{.x = x, .y = y};
      std::array<double, kMaxCandidates> values{};
      const auto offer = [&](int px, int py) {
        if (!segments.Contains(px, py) || choice.count == kMaxCandidates) return;
        const SegmentIndex s = segments(px, py);
        const double u = view.planes[s].At(x, y);
        for (std::size_t i = 0; i < choice.count; ++i)
          if (std::abs(values[i] - u) <= kDistinct) return;
        values[choice.count] = u;
        choice.segments[choice.count++] = s;
      };
      offer(x, y);
      for (int d = 1; d <= kReach; ++d)
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}})
          offer(x + d * dx, y + d * dy);
      if (choice.count < 2) continue;
      for (std::size_t i = 0; i < choice.count; ++i)
        choice.costs[i] = PatchCost(own, others, view.planes[choice.segments[i]], x, y);
      choices.push_back(choice);
    }
  }
  for (int sweep = 0; sweep < 3; ++sweep) {
    for (const Choice& choice : choices) {
      double best = 1e30;
      SegmentIndex chosen = segments(choice.x, choice.y);
      for (std::size_t i = 0; i < choice.count; ++i) {
        double cost = choice.costs[i];
        const double u = view.planes[choice.segments[i]].At(choice.x, choice.y);
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int nx = choice.x + dx;
          const int ny = choice.y + dy;
          if (!segments.Contains(nx, ny)) continue;
          const double gap = std::abs(view.planes[segments(nx, ny)].At(nx, ny) - u);
          cost += kPairCost * std::min(1.0, gap / 0.5) * ColourWeight(own(choice.x, choice.y), own(nx, ny));
        }
        if (cost < best) {
          best = cost;
          chosen = choice.segments[i];
        }
      }
      segments(choice.x, choice.y) = chosen;
    }
  }
}

}  // namespace

std::vector<RefinedView> RefinePlanes(const ResolvedJob& job, const FrameAnalysis& analysis, const LabelField& labels,
                                      int rounds) {
  const std::vector<ViewGeometry> geometry = RefinementGeometry(job);
  const std::size_t n = analysis.size();
  std::vector<RefinedView> views(n);
  std::vector<InverseDepthMap> maps;
  for (std::size_t v = 0; v < n; ++v) {
    views[v].segment_of_pixel = analysis[v]->segments.labels;
    std::vector<SlantedPlane> of_level;
    of_level.reserve(static_cast<std::size_t>(job.params.levels));
    for (int level = 0; level < job.params.levels; ++level)
      of_level.push_back(PlaneOfLevel(job, static_cast<int>(v), geometry[v], static_cast<Level>(level)));
    for (const Level level : labels.views[v].levels) views[v].planes.push_back(of_level[level]);
    maps.push_back(MapOf(views[v]));
  }
  for (int round = 0; round < rounds; ++round) {
    const bool blur = round == 0;
    const bool choose = round >= rounds - 2;
    std::vector<ColourGrid> colours;
    for (const auto& view : analysis) colours.push_back(ColourOf(view->picture, blur));
    const double progress = rounds > 1 ? static_cast<double>(round) / (rounds - 1) : 1;
    const double gap_scale = 1 - 0.8 * progress;
    for (std::size_t v = 0; v < n; ++v) {
      std::vector<OtherView> others;
      for (const PairGeometry& pair : geometry[v].pairs) {
        const auto other = static_cast<std::size_t>(pair.other);
        OtherView entry{.pair = &pair, .colour = &colours[other], .map = &maps[other]};
        entry.sigma = MeasureNoise(colours[v], maps[v], entry);
        others.push_back(entry);
      }
      const auto& segments = analysis[v]->segments;
      auto data = DataTerm(colours[v], maps[v], views[v].segment_of_pixel, segments.centers, others, blur);
      if (choose) AddAgreement(maps[v], segments.centers, others, data);
      SolvePlanes(segments, data, gap_scale, views[v].planes);
      if (choose) ChoosePlanes(colours[v], others, views[v]);
    }
    for (std::size_t v = 0; v < n; ++v) maps[v] = MapOf(views[v]);
  }
  return views;
}

}  // namespace depthfarm
