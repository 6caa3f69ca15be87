#include "worker/refinement/prior_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "worker/refinement/better_half.h"

namespace depthfarm {
namespace {

constexpr std::size_t kFewestTold = 30;  // segments that a prior is judged by
constexpr double kAgrees = 0.5;          // pixels of u
constexpr int kFitRounds = 12;
constexpr double kLeastSpread = 1;      // pixels of u, of what a scale is fitted to: any prior fits a level wall
constexpr double kMoreAgree = 0.05;     // of the told segments: what a fit must gain where values have a scale
constexpr double kMostRescaled = 1.25;  // by such a fit, or as much less
constexpr int kCell = 64;               // pixels: trust is of 3 x 3 cells
constexpr double kPseudoSegments = 20;  // the whole picture's share counts as many
constexpr double kJump = 1;             // pixels of u between adjacent segments
// Where trust begins and where it is full: shares of told segments that agree, and noise in pixels of u.
constexpr double kNoTrust = 0.5;
constexpr double kFullTrust = 0.9;
constexpr double kNoTrustAtJumps = 0.6;  // levels are coarse there, and contours of segments rough
constexpr double kFullTrustAtJumps = 0.75;
constexpr double kNoTrustNoise = 0.4;
constexpr double kFullTrustNoise = 0.1;
constexpr double kLeastSigma = 0.1;
constexpr double kMoves = 0.35;   // pixels of u: less is left to the rounds
constexpr double kBetter = 0.02;  // of misfit: evidence that a prior that is not trusted needs
constexpr double kAboutAsGood = 0.01;
constexpr double kPullScale = 0.5;  // pixels of u

// A segment that the prior is judged by.
struct Told {
  SegmentIndex segment = 0;
  double prior = 0;  // at the segment's centre
  double depth = 0;
};

struct Affine {
  double scale = 1;
  double shift = 0;
  [[nodiscard]] double operator()(double value) const { return scale * value + shift; }
};

bool Agrees(const Told& told, const Affine& affine) { return std::abs(affine(told.prior) - told.depth) < kAgrees; }

double ShareThatAgrees(std::span<const Told> told, const Affine& affine) {
  const auto agreeing = std::count_if(told.begin(), told.end(), [&](const Told& t) { return Agrees(t, affine); });
  return static_cast<double>(agreeing) / static_cast<double>(told.size());
}

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double MedianResidual(std::span<const Told> told, const Affine& affine) {
  std::vector<double> residuals;
  residuals.reserve(told.size());
  for (const Told& t : told) residuals.push_back(std::abs(affine(t.prior) - t.depth));
  return Median(residuals);
}

// Robust least squares; nullopt where the prior or the depth hardly varies, or nearer is farther.
std::optional<Affine> FitAffine(std::span<const Told> told) {
  Affine affine;
  for (int round = 0; round < kFitRounds; ++round) {
    const double scale = round == 0 ? 0 : std::max(kAgrees, 1.5 * MedianResidual(told, affine));
    const auto weight = [&](const Told& t) {
      if (round == 0) return 1.0;
      const double e = (affine(t.prior) - t.depth) / scale;
      return 1 / ((1 + e * e) * (1 + e * e));
    };
    double w = 0;
    double p = 0;
    double d = 0;
    for (const Told& t : told) {
      const double wt = weight(t);
      w += wt;
      p += wt * t.prior;
      d += wt * t.depth;
    }
    double pp = 0;
    double pd = 0;
    double dd = 0;
    for (const Told& t : told) {
      const double wt = weight(t);
      pp += wt * (t.prior - p / w) * (t.prior - p / w);
      pd += wt * (t.prior - p / w) * (t.depth - d / w);
      dd += wt * (t.depth - d / w) * (t.depth - d / w);
    }
    if (!(pp > 0) || !(pd > 0) || dd < kLeastSpread * kLeastSpread * w) return std::nullopt;
    affine = {pd / pp, d / w - pd / pp * (p / w)};
  }
  return affine;
}

// Whether values that have a scale are the better for another one.
bool IsBetter(std::span<const Told> told, const Affine& affine) {
  return affine.scale < kMostRescaled && affine.scale > 1 / kMostRescaled &&
         ShareThatAgrees(told, affine) > ShareThatAgrees(told, {}) + kMoreAgree;
}

// By how much adjacent planes fail to meet, pixels of u at the two centres; -1 where one of them says nothing.
template <typename Says>
double GapBetween(const SegmentMap& segments, std::span<const SlantedPlane> planes, const SegmentMap::Adjacency& pair,
                  const Says& says) {
  if (!says(pair.first) || !says(pair.second)) return -1;
  const auto gap_at = [&](const PixelPosition& p) {
    return std::abs(planes[pair.first].At(p.x, p.y) - planes[pair.second].At(p.x, p.y));
  };
  return 0.5 * (gap_at(segments.centers[pair.first]) + gap_at(segments.centers[pair.second]));
}

// Where a view or its prior, or both, jump: 1 for the segments beside.
template <typename Says>
void MarkBesideJumps(const SegmentMap& segments, std::span<const SlantedPlane> planes, const Says& says,
                     std::vector<std::uint8_t>& beside) {
  for (const SegmentMap::Adjacency& pair : segments.adjacency)
    if (GapBetween(segments, planes, pair, says) > kJump) beside[pair.first] = beside[pair.second] = 1;
}

// Median gap between adjacent planes of the prior: a surface has next to none.
double NoiseOf(const SegmentMap& segments, std::span<const SlantedPlane> planes, std::span<const SegmentPrior> prior) {
  const auto says = [&](SegmentIndex s) { return prior[s].weight > 0; };
  std::vector<double> gaps;
  for (const SegmentMap::Adjacency& pair : segments.adjacency)
    if (const double gap = GapBetween(segments, planes, pair, says); gap >= 0) gaps.push_back(gap);
  return gaps.empty() ? 0 : Median(gaps);  // none of the sparse ones has a neighbour
}

// For each segment the share of told ones around it that agree.
class LocalShare {
 public:
  LocalShare(const SegmentMap& segments, std::span<const Told> told)
      : cells_((segments.labels.width() + kCell - 1) / kCell, (segments.labels.height() + kCell - 1) / kCell),
        share_(ShareThatAgrees(told, {})) {
    for (const Told& t : told) {
      const auto [x, y] = segments.centers[t.segment];
      Cell& cell = cells_(x / kCell, y / kCell);
      cell.told += 1;
      if (Agrees(t, {})) cell.agree += 1;
    }
  }

  [[nodiscard]] double At(const PixelPosition& center) const {
    const int cx = center.x / kCell;
    const int cy = center.y / kCell;
    double told = kPseudoSegments;
    double agree = kPseudoSegments * share_;
    for (int y = std::max(0, cy - 1); y <= std::min(cells_.height() - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(cells_.width() - 1, cx + 1); ++x) {
        told += cells_(x, y).told;
        agree += cells_(x, y).agree;
      }
    }
    return agree / told;
  }

 private:
  struct Cell {
    double told = 0;
    double agree = 0;
  };
  Grid<Cell> cells_;
  double share_;
};

// 0 at `none` to 1 at `full`.
double Ramp(double value, double none, double full) { return std::clamp((value - none) / (full - none), 0.0, 1.0); }

double SpreadOfAgreeing(std::span<const Told> told) {
  double squares = 0;
  double count = 0;
  for (const Told& t : told) {
    if (!Agrees(t, {})) continue;
    squares += (t.prior - t.depth) * (t.prior - t.depth);
    count += 1;
  }
  return count > 0 ? std::max(kLeastSigma, std::sqrt(squares / count)) : kAgrees;
}

// The segments to judge planes of the prior by.
std::vector<Told> Judges(std::span<const SegmentPrior> prior, std::span<const SlantedPlane> planes,
                         const SegmentMap& segments, std::span<const std::uint8_t> told, const RefinedView& view) {
  std::vector<Told> judges;
  for (SegmentIndex s = 0; s < prior.size(); ++s) {
    if (!(prior[s].weight > 0) || told[s] == 0) continue;
    const auto [x, y] = segments.centers[s];
    judges.push_back({s, planes[s].At(x, y), view.planes[s].At(x, y)});
  }
  return judges;
}

std::vector<SlantedPlane> PlanesOf(std::span<const SegmentPrior> prior, const Affine& affine) {
  std::vector<SlantedPlane> planes(prior.size());
  for (std::size_t s = 0; s < prior.size(); ++s) {
    if (!(prior[s].weight > 0)) continue;
    planes[s] = {static_cast<float>(affine.scale * prior[s].a), static_cast<float>(affine.scale * prior[s].b),
                 static_cast<float>(affine(prior[s].c))};
  }
  return planes;
}

}  // namespace

std::optional<PriorField> FitPrior(const ViewPrior& prior, const PriorScale& scale, const SegmentMap& segments,
                                   std::span<const std::uint8_t> told, const RefinedView& view) {
  const std::span<const SegmentPrior> of_segments = prior.segments;
  Affine affine{scale.scale, 0};
  std::vector<Told> judges = Judges(of_segments, PlanesOf(of_segments, affine), segments, told, view);
  if (judges.size() < kFewestTold) return std::nullopt;
  const std::optional<Affine> fitted = FitAffine(judges);
  if (scale.fit && !fitted) return std::nullopt;
  if (fitted && (scale.fit || IsBetter(judges, *fitted))) affine = {fitted->scale * affine.scale, fitted->shift};

  PriorField field{.planes = PlanesOf(of_segments, affine),
                   .known = std::vector<std::uint8_t>(of_segments.size()),
                   .trust = std::vector<float>(of_segments.size())};
  field.pixels = &prior;
  field.scale = affine.scale;
  field.shift = affine.shift;
  judges = Judges(of_segments, field.planes, segments, told, view);
  field.sigma = SpreadOfAgreeing(judges);

  std::vector<std::uint8_t> beside(of_segments.size());
  MarkBesideJumps(
      segments, field.planes, [&](SegmentIndex s) { return of_segments[s].weight > 0; }, beside);
  MarkBesideJumps(
      segments, view.planes, [](SegmentIndex) { return true; }, beside);
  const LocalShare share(segments, judges);
  std::erase_if(judges, [&](const Told& t) { return beside[t.segment] == 0; });
  const double trust_at_jumps =
      judges.size() < kFewestTold ? 0 : Ramp(ShareThatAgrees(judges, {}), kNoTrustAtJumps, kFullTrustAtJumps);
  const double trust_of_all = Ramp(NoiseOf(segments, field.planes, of_segments), kNoTrustNoise, kFullTrustNoise);
  for (SegmentIndex s = 0; s < of_segments.size(); ++s) {
    if (!(of_segments[s].weight > 0)) continue;
    const double trust = trust_of_all * Ramp(share.At(segments.centers[s]), kNoTrust, kFullTrust) *
                         (beside[s] != 0 ? trust_at_jumps : 1);
    field.known[s] = 1;
    field.trust[s] = static_cast<float>(trust * std::min(1.0F, of_segments[s].weight));
  }
  return field;
}

double TrustedShare(const PriorField* prior) {
  if (prior == nullptr) return 0;
  const auto known = std::ranges::count(prior->known, 1);
  const auto trusted = std::ranges::count_if(prior->trust, [](float trust) { return trust >= kTrusted; });
  return known > 0 ? static_cast<double>(trusted) / static_cast<double>(known) : 0;
}

void TakePrior(const PictureColours& own, const SegmentMap& segments, const PriorField& prior,
               std::span<const std::uint8_t> decided, std::span<const OtherView> others, RefinedView& view) {
  const std::size_t num_segments = segments.centers.size();
  struct Misfits {
    double now = 0;
    double with_prior = 0;
    int pixels = 0;
  };
  std::vector<std::uint8_t> asked(num_segments);
  for (SegmentIndex s = 0; s < num_segments; ++s) {
    const auto [x, y] = segments.centers[s];
    const bool open = view.kept[s] == 0 && decided[s] == 0 && prior.trust[s] > 0;
    asked[s] = open && std::abs(prior.planes[s].At(x, y) - view.planes[s].At(x, y)) > kMoves ? 1 : 0;
  }
  std::vector<Misfits> misfits(num_segments);
  for (int y = 0; y < segments.labels.height(); ++y) {
    for (int x = 0; x < segments.labels.width(); ++x) {
      const SegmentIndex s = segments.labels(x, y);
      if (asked[s] == 0) continue;
      const auto misfit = [&](const SlantedPlane& plane) {
        BetterHalf half;
        for (const OtherView& other : others)
          if (const auto rho = MisfitInFreeSpace(own(x, y), other, x, y, plane.At(x, y))) half.Add(*rho);
        return half.Mean();
      };
      misfits[s].now += misfit(view.planes[s]);
      misfits[s].with_prior += misfit(prior.planes[s]);
      ++misfits[s].pixels;
    }
  }
  for (SegmentIndex s = 0; s < num_segments; ++s) {
    if (asked[s] == 0) continue;
    const double gain = (misfits[s].now - misfits[s].with_prior) / misfits[s].pixels;
    if (gain > (prior.trust[s] >= kTrusted ? -kAboutAsGood : kBetter)) view.planes[s] = prior.planes[s];
  }
}

void AddPrior(const PriorField& prior, const RefinedView& refined, std::span<const PixelPosition> centers,
              std::vector<NormalEquations>& equations) {
  const double information = 1 / (prior.sigma * prior.sigma);
  for (SegmentIndex s = 0; s < centers.size(); ++s) {
    if (!prior.Says(s)) continue;
    const auto [x, y] = centers[s];
    const double change = prior.planes[s].At(x, y) - refined.planes[s].At(x, y);
    const double t = change / kPullScale;
    const double weight = prior.trust[s] * prior.trust[s] * information / ((1 + t * t) * (1 + t * t));
    equations[s].h[5] += weight;
    equations[s].rhs[2] += weight * change;
  }
}

}  // namespace depthfarm
