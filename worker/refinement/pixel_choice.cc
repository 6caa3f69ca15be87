#include "worker/refinement/pixel_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "worker/refinement/colour_weight.h"
#include "worker/refinement/known_costs.h"
#include "worker/refinement/patch_cost.h"

namespace depthfarm {
namespace {

constexpr double kJump = 0.5;       // pixels of u between neighbours: a depth jump
constexpr double kHighestJump = 8;  // the bound is raised to find fewer, but not beyond
constexpr double kMaxBand = 0.25;   // of the picture, before the bound is raised
constexpr int kBand = 4;            // pixels to either side of a jump
constexpr int kReach = 2;           // candidates come from as far, in each pass
constexpr int kMostPasses = 40;     // usually nothing is left to do before; two choices may swap for ever
constexpr double kDistinct = 0.15;  // pixels of u between candidates
constexpr std::size_t kMaxCandidates = 5;
constexpr double kUnknown = -1;  // cost
constexpr int kSweeps = 3;
constexpr std::size_t kCostsBetweenStopChecks = 1U << 12;
constexpr double kPriorCost = 0.3;  // of rho, for a plane that the prior speaks against
constexpr double kPriorScale = 1;   // pixels of u at which it does so in full
constexpr double kPairCost = 0.05;  // of rho, for neighbours on different surfaces
constexpr double kPairScale = 0.5;  // pixels of u at which they are that

constexpr std::array<std::pair<int, int>, 4> kFourNeighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
constexpr std::array<std::pair<int, int>, 8> kEightDirections{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};

void MarkAround(int x0, int y0, int radius, Grid<std::uint8_t>& marked) {
  for (int y = std::max(0, y0 - radius); y <= std::min(marked.height() - 1, y0 + radius); ++y)
    for (int x = std::max(0, x0 - radius); x <= std::min(marked.width() - 1, x0 + radius); ++x) marked(x, y) = 1;
}

Grid<std::uint8_t> PixelsNearJumps(const InverseDepthMap& map, double jump) {
  Grid<std::uint8_t> band(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if ((x + 1 < map.width() && std::abs(map(x, y) - map(x + 1, y)) > jump) ||
          (y + 1 < map.height() && std::abs(map(x, y) - map(x, y + 1)) > jump))
        MarkAround(x, y, kBand, band);
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

// The planes that one pixel may take.
struct Choice {
  int x = 0;
  int y = 0;
  std::array<PlaneIndex, kMaxCandidates> planes{};
  std::array<double, kMaxCandidates> costs{};
  std::array<double, kMaxCandidates> u{};              // of each plane here
  std::array<double, kFourNeighbours.size()> links{};  // what another surface at each neighbour costs
  std::size_t count = 0;
};

Choice CandidatesAt(const RefinedView& view, int x, int y) {
  Choice choice{.x = x, .y = y};
  const auto offer = [&](int px, int py) {
    if (!view.plane_of_pixel.Contains(px, py) || choice.count == kMaxCandidates) return;
    const PlaneIndex plane = view.plane_of_pixel(px, py);
    const double u = view.planes[plane].At(x, y);
    for (std::size_t i = 0; i < choice.count; ++i)
      if (std::abs(choice.u[i] - u) <= kDistinct) return;
    choice.u[choice.count] = u;
    choice.planes[choice.count++] = plane;
  };
  offer(x, y);
  for (int d = 1; d <= kReach; ++d)
    for (const auto& [dx, dy] : kEightDirections) offer(x + d * dx, y + d * dy);
  return choice;
}

// Sets the costs that are known; the others are kUnknown, and true is returned if there are none.
bool FillKnown(const KnownCosts& known, Choice& choice) {
  bool all = true;
  for (std::size_t i = 0; i < choice.count; ++i) {
    choice.costs[i] = known.Find(choice.x, choice.y, choice.planes[i]).value_or(kUnknown);
    all = all && choice.costs[i] != kUnknown;
  }
  return all;
}

// Plane by plane, as PatchCost asks for.
void FillCosts(const RefinedView& view, PatchCost& cost, KnownCosts& known, std::vector<Choice>& choices,
               const std::stop_token& stop) {
  struct Candidate {
    PlaneIndex plane = 0;
    std::uint32_t choice = 0;
    std::uint32_t index = 0;
  };
  std::vector<Candidate> candidates;
  for (std::size_t c = 0; c < choices.size(); ++c) {
    if (FillKnown(known, choices[c])) continue;
    for (std::size_t i = 0; i < choices[c].count; ++i) {
      if (choices[c].costs[i] == kUnknown)
        candidates.push_back({choices[c].planes[i], static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(i)});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.plane, a.choice) < std::tie(b.plane, b.choice);
  });
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i % kCostsBetweenStopChecks == 0 && stop.stop_requested()) return;
    const auto& [plane, c, index] = candidates[i];
    Choice& choice = choices[c];
    choice.costs[index] = cost.At(choice.x, choice.y, plane, view.planes[plane]);
    known.Keep(choice.x, choice.y, plane, choice.costs[index]);
  }
}

// What the prior has against each plane, where it says something.
void AddPriorCosts(const Grid<SegmentIndex>& segments, const PriorField& prior, std::vector<Choice>& choices) {
  for (Choice& choice : choices) {
    const std::optional<double> u = prior.At(choice.x, choice.y);
    if (!u) continue;
    const double weight = kPriorCost * prior.trust[segments(choice.x, choice.y)];
    for (std::size_t i = 0; i < choice.count; ++i) {
      const double gap = std::abs(choice.u[i] - *u);
      choice.costs[i] += weight * std::min(1.0, gap / kPriorScale);
    }
  }
}

PlaneIndex BestPlane(const RefinedView& view, const Choice& choice) {
  std::array<double, kFourNeighbours.size()> beside{};
  for (std::size_t n = 0; n < beside.size(); ++n) {
    const auto [dx, dy] = kFourNeighbours[n];
    if (choice.links[n] > 0) beside[n] = view.At(choice.x + dx, choice.y + dy);
  }
  double best = std::numeric_limits<double>::infinity();
  PlaneIndex chosen = choice.planes[0];
  for (std::size_t i = 0; i < choice.count; ++i) {
    double cost = choice.costs[i];
    for (std::size_t n = 0; n < beside.size(); ++n)
      cost += choice.links[n] * std::min(1.0, std::abs(beside[n] - choice.u[i]) / kPairScale);
    if (cost < best) {
      best = cost;
      chosen = choice.planes[i];
    }
  }
  return chosen;
}

void LinkToNeighbours(const YcbcrImage& own, Choice& choice) {
  for (std::size_t n = 0; n < choice.links.size(); ++n) {
    const int x = choice.x + kFourNeighbours[n].first;
    const int y = choice.y + kFourNeighbours[n].second;
    if (own.Contains(x, y)) choice.links[n] = kPairCost * ColourWeight(own(choice.x, choice.y), own(x, y));
  }
}

// The choices at the marked pixels that have one and may move.
std::vector<Choice> ChoicesAt(const Grid<std::uint8_t>& marked, const Grid<SegmentIndex>& segments,
                              const YcbcrImage& own, const RefinedView& view) {
  std::vector<Choice> choices;
  for (int y = 0; y < marked.height(); ++y) {
    for (int x = 0; x < marked.width(); ++x) {
      if (marked(x, y) == 0 || view.kept[segments(x, y)] != 0) continue;
      Choice choice = CandidatesAt(view, x, y);
      if (choice.count < 2) continue;
      LinkToNeighbours(own, choice);
      choices.push_back(choice);
    }
  }
  return choices;
}

// The pixels that may have got another candidate: those near one that has another plane than it had (planes[0]).
Grid<std::uint8_t> NearChanges(const std::vector<Choice>& choices, const RefinedView& view) {
  Grid<std::uint8_t> near(view.plane_of_pixel.width(), view.plane_of_pixel.height());
  for (const Choice& choice : choices)
    if (view.plane_of_pixel(choice.x, choice.y) != choice.planes[0]) MarkAround(choice.x, choice.y, kReach, near);
  return near;
}

}  // namespace

void ChoosePlanes(const YcbcrImage& own, const Grid<SegmentIndex>& segments, std::span<const OtherView> others,
                  const PriorField* prior, RefinedView& view, const std::stop_token& stop) {
  PatchCost cost(own, others);  // of all passes: planes and maps stay, only who has which plane changes
  KnownCosts known(own.width(), own.height());
  Grid<std::uint8_t> open = JumpBand(view.Map());
  for (int pass = 0; pass < kMostPasses && !stop.stop_requested(); ++pass) {
    std::vector<Choice> choices = ChoicesAt(open, segments, own, view);
    if (choices.empty()) return;
    FillCosts(view, cost, known, choices, stop);
    if (stop.stop_requested()) return;
    if (prior != nullptr) AddPriorCosts(segments, *prior, choices);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (const Choice& choice : choices) view.plane_of_pixel(choice.x, choice.y) = BestPlane(view, choice);
    open = NearChanges(choices, view);
  }
}

}  // namespace depthfarm
