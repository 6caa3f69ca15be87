#include "worker/confidence/confidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "worker/refinement/better_half.h"
#include "worker/refinement/colour_weight.h"
#include "worker/refinement/other_view.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {
namespace {

// Log odds of being wrong: a logistic regression on every seventh pixel of the eight 640x480 scenes of scene set v1's
// tuning list; docs/method.md, 9.
constexpr double kBase = -8.12;
constexpr double kOfMisfit = 5.3;  // of misfit / (misfit + kHalfMisfit)
constexpr double kHalfMisfit = 0.03;
constexpr double kOfMargin = -1.02;  // of margin / (margin + kHalfMargin)
constexpr double kHalfMargin = 0.02;
constexpr std::array<double, 3> kOfAgreeing = {0.88, 0.81, 0.58};  // none, one, two; more: 0
constexpr double kOfSeenThrough = 1.31;
constexpr double kOfNearestGap = 1.58;
constexpr double kOfMeanGap = 2.98;
constexpr std::array<std::pair<int, double>, 3> kOfJump = {{{1, 0.63}, {2, 0.41}, {4, 0.74}}};  // at most so far: add

constexpr double kElsewhere = 2;    // pixels of u: where a pixel must fit worse to be sure
constexpr double kAgreement = 0.5;  // pixels of u
constexpr float kJump = 0.5F;       // pixels of u between neighbours
constexpr float kNotSeen = -1;
constexpr int kRowsBetweenStopChecks = 16;

// exp(t) without the library's, whose last bits differ between machines: (1 + t / 1024)^1024, 3 % off at t = 8.
double Exponential(double t) {
  double power = std::max(0.0, 1 + t / 1024);
  for (int i = 0; i < 10; ++i) power *= power;
  return power;
}

// In whole steps that may be diagonal, to the nearest pixel that a depth jump lies beside.
Grid<std::uint8_t> DistanceToJumps(const InverseDepthMap& map) {
  Grid<std::uint8_t> distance(map.width(), map.height(), Evidence::kFarFromJumps);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (x + 1 < map.width() && std::abs(map(x + 1, y) - map(x, y)) > kJump) distance(x, y) = distance(x + 1, y) = 0;
      if (y + 1 < map.height() && std::abs(map(x, y + 1) - map(x, y)) > kJump) distance(x, y) = distance(x, y + 1) = 0;
    }
  }
  // One sweep down and one up hand every pixel's distance on to those beside it.
  const auto hand_on = [&distance](int x, int y, int side) {
    constexpr std::array<std::pair<int, int>, 4> kBefore = {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
    for (const auto& [dx, dy] : kBefore) {
      const int nx = x + side * dx;
      const int ny = y + side * dy;
      if (distance.Contains(nx, ny))
        distance(x, y) = std::min(distance(x, y), static_cast<std::uint8_t>(distance(nx, ny) + 1));
    }
  };
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) hand_on(x, y, 1);
  for (int y = map.height() - 1; y >= 0; --y)
    for (int x = map.width() - 1; x >= 0; --x) hand_on(x, y, -1);
  return distance;
}

// One of the other views, as the pixels of the view see it with the depth they have.
struct Compared {
  std::array<Grid<float>, 3> misfit;  // rho there, kElsewhere nearer and farther; kNotSeen where not seen
  Grid<float> gap;                    // pixels of u between the depths of both; only where seen
  Grid<std::uint8_t> sees_through;
};

Compared Compare(const YcbcrImage& own, const InverseDepthMap& map, const OtherView& other) {
  const Grid<float> nowhere(own.width(), own.height(), kNotSeen);
  Compared compared{{nowhere, nowhere, nowhere}, {own.width(), own.height()}, {own.width(), own.height()}};
  for (int y = 0; y < own.height(); ++y) {
    for (int x = 0; x < own.width(); ++x) {
      const double u = map(x, y);
      const Colour colour = ColourOf(own(x, y));
      const std::optional<Seen> seen = SeenIn(*other.pair, *other.map, x, y, u);
      const auto elsewhere = [&](double offset) {
        return static_cast<float>(Misfit(colour, other, x, y, u + offset).value_or(double{kNotSeen}));
      };
      compared.misfit[1](x, y) = elsewhere(kElsewhere);
      compared.misfit[2](x, y) = elsewhere(-kElsewhere);
      if (!seen) continue;
      compared.misfit[0](x, y) = static_cast<float>(MisfitAt(colour, other, *seen));
      compared.gap(x, y) = static_cast<float>(std::abs(DepthAt(*other.map, *seen) - seen->u_in_other));
      compared.sees_through(x, y) = SeesThrough(*other.map, *seen) ? 1 : 0;
    }
  }
  return compared;
}

using Weights = std::array<double, 9>;  // of the 3 x 3 pixels around one: those alike in colour count most

// Mean over the 3 x 3 pixels around; kNotSeen where none is seen.
double MeanMisfit(const Grid<float>& misfit, const Weights& weights, int x0, int y0) {
  double sum = 0;
  double weight_sum = 0;
  for (int i = 0; i < 9; ++i) {
    const int x = x0 + i % 3 - 1;
    const int y = y0 + i / 3 - 1;
    if (!misfit.Contains(x, y) || misfit(x, y) == kNotSeen) continue;
    const double weight = weights[static_cast<std::size_t>(i)];
    sum += weight * static_cast<double>(misfit(x, y));
    weight_sum += weight;
  }
  return weight_sum > 0 ? sum / weight_sum : static_cast<double>(kNotSeen);
}

// Mean of those over the better half of the views that see it; `place`: of Compared::misfit.
double MisfitOfBetterHalf(const std::vector<Compared>& others, std::size_t place, const Weights& weights, int x,
                          int y) {
  BetterHalf means;
  for (const Compared& other : others) {
    const double mean = MeanMisfit(other.misfit[place], weights, x, y);
    if (mean >= 0) means.Add(mean);
  }
  return means.Mean();
}

Evidence EvidenceAt(const YcbcrImage& own, const std::vector<Compared>& others, int to_jump, int x, int y) {
  Weights weights{};
  for (int i = 0; i < 9; ++i) {
    const int nx = x + i % 3 - 1;
    const int ny = y + i / 3 - 1;
    if (own.Contains(nx, ny)) weights[static_cast<std::size_t>(i)] = ColourWeight(own(nx, ny), own(x, y));
  }
  Evidence evidence;
  evidence.to_jump = to_jump;
  evidence.misfit = MisfitOfBetterHalf(others, 0, weights, x, y);
  const double elsewhere =
      std::min(MisfitOfBetterHalf(others, 1, weights, x, y), MisfitOfBetterHalf(others, 2, weights, x, y));
  evidence.margin = std::max(0.0, elsewhere - evidence.misfit);
  int seen = 0;
  double gaps = 0;
  for (const Compared& other : others) {
    if (other.misfit[0](x, y) == kNotSeen) continue;
    const auto gap = static_cast<double>(other.gap(x, y));
    ++seen;
    gaps += gap;
    evidence.nearest_gap = std::min(evidence.nearest_gap, gap);
    if (gap < kAgreement) ++evidence.agreeing;
    if (other.sees_through(x, y) != 0) evidence.seen_through = true;
  }
  if (seen > 0) evidence.mean_gap = std::min(1.0, gaps / seen);
  return evidence;
}

}  // namespace

double ProbabilityOfRight(const Evidence& evidence) {
  double wrong = kBase + kOfMisfit * evidence.misfit / (evidence.misfit + kHalfMisfit) +
                 kOfMargin * evidence.margin / (evidence.margin + kHalfMargin);
  if (const auto agreeing = static_cast<std::size_t>(evidence.agreeing); agreeing < kOfAgreeing.size())
    wrong += kOfAgreeing[agreeing];
  if (evidence.seen_through) wrong += kOfSeenThrough;
  wrong += kOfNearestGap * evidence.nearest_gap + kOfMeanGap * evidence.mean_gap;
  for (const auto& [distance, log_odds] : kOfJump)
    if (evidence.to_jump <= distance) wrong += log_odds;
  return 1 / (1 + Exponential(wrong));
}

Result<ConfidenceMap> AssessView(const ResolvedJob& job, int view, const FrameAnalysis& analysis,
                                 const FrameRefinement& refined, const std::stop_token& stop) {
  DEPTHFARM_RETURN_IF_ERROR(CheckViewInputs(job, view, analysis, refined));
  const auto v = static_cast<std::size_t>(view);
  const ViewGeometry geometry = RefinementGeometry(job, view);
  const YcbcrImage& own = analysis[v]->picture;
  const InverseDepthMap map = refined[v]->Map();
  std::vector<Compared> others;
  for (const PairGeometry& pair : geometry.pairs) {
    if (stop.stop_requested()) return Cancelled();
    const auto o = static_cast<std::size_t>(pair.other);
    const InverseDepthMap other_map = refined[o]->Map();
    OtherView other{.pair = &pair, .colour = analysis[o]->picture, .map = &other_map};
    other.sigma = MeasureNoise(own, map, other);
    others.push_back(Compare(own, map, other));
  }
  const Grid<std::uint8_t> to_jump = DistanceToJumps(map);
  ConfidenceMap confidence{Grid<std::uint16_t>(own.width(), own.height())};
  for (int y = 0; y < own.height(); ++y) {
    if (y % kRowsBetweenStopChecks == 0 && stop.stop_requested()) return Cancelled();
    for (int x = 0; x < own.width(); ++x) {
      const double right = ProbabilityOfRight(EvidenceAt(own, others, to_jump(x, y), x, y));
      const double half_up = kConfidenceScale * right + 0.5;
      confidence.codes(x, y) = static_cast<std::uint16_t>(half_up);
    }
  }
  return confidence;
}

}  // namespace depthfarm
