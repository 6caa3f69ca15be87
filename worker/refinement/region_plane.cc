#include "worker/refinement/region_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "common/base/parallel.h"
#include "worker/refinement/region_fit.h"
#include "worker/refinement/region_parts.h"

namespace depthfarm {
namespace {

constexpr double kDistinct = 0.15;  // pixels of u at the region's centre between candidates
constexpr double kAlike = 40;       // grey levels, summed over the components: of a pixel and the region
constexpr double kNearer = 2;       // pixels of u: beyond the far side by more is an occluder
constexpr int kBesideOccluder = 3;  // pixels that its mixed colours may reach
constexpr std::size_t kFewestPixels = 50;
constexpr std::size_t kManyPixels = 8000;  // of a region k times as large every k-th is judged
constexpr double kSupports = 0.35;         // pixels of u: a segment of the rim lies on a plane
constexpr double kLeastSupport = 0.05;     // of the rim
constexpr double kAsGood = 0.2;            // of misfit for each segment of the rim
constexpr double kMostUnseen = 0.5;        // of the judged pixels
constexpr double kPlate = 0.9;             // of the region on one plane
constexpr double kLeastSaid = 0.5;         // of the region, by a prior
// How often the plane through the rim is moved by kDistinct, nearer and farther. The rim is on levels about a pixel
// apart, so that plane may be half a pixel off; but a pixel behind the rim is what that hides.
constexpr int kMoves = 4;

double CentreDepth(const SlantedPlane& plane, const PixelPosition& center) { return plane.At(center.x, center.y); }

// The far side of what surrounds a region: an eighth of it lies farther. Reorders the values.
double FarSide(std::vector<double>& values) {
  const auto far = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 8);
  std::nth_element(values.begin(), far, values.end());
  return *far;
}

struct Candidate {
  SlantedPlane plane;
  double u = 0;             // at the region's centre
  std::size_t support = 0;  // segments of the rim that lie on it
  Judgement fit;
};

// What a region takes.
struct Choice {
  bool prior = false;  // each segment its plane of the prior
  SlantedPlane plane;
};

// One region of a view.
class Decision {
 public:
  Decision(const PictureColours& own, const SegmentMap& segments, const PlainRegion& region,
           std::span<const OtherView> others, const PriorField* prior, const RefinedView& view)
      : fit_(own, others), segments_(segments), region_(region), prior_(prior), view_(view) {}

  // Of the region's pixels those that tell how deep it is, a few thousand of many; known once the choice is made.
  [[nodiscard]] std::span<const PixelPosition> judged() const { return judged_; }

  // `pixels`: the region's, in any fixed order.
  std::optional<Choice> Make(std::vector<PixelPosition> pixels) {
    for (const auto& [x, y] : pixels) {
      center_x_ += x;
      center_y_ += y;
    }
    center_x_ /= static_cast<double>(pixels.size());
    center_y_ /= static_cast<double>(pixels.size());
    pixels_ = AwayFromOccluders(OfItsColour(std::move(pixels)));
    if (pixels_.size() < kFewestPixels) return std::nullopt;
    for (std::size_t i = 0; i < pixels_.size(); i += Step()) judged_.push_back(pixels_[i]);
    std::vector<Candidate> candidates = Candidates();
    const Candidate* best = JudgeAll(candidates);
    const Candidate* chosen = best == nullptr ? nullptr : &Choose(candidates, *best);
    const Judgement current = Judge([this](int x, int y) { return view_.At(x, y); });
    const bool keeps = chosen == nullptr || Excess(current, chosen->fit) <= 0;
    if (TakesPrior(keeps ? current : chosen->fit)) return Choice{.prior = true, .plane = {}};
    if (chosen == nullptr) return std::nullopt;
    if (!IsPlate() && Excess(current, chosen->fit) <= Tolerance()) return std::nullopt;
    return Choice{.prior = false, .plane = chosen->plane};
  }

 private:
  [[nodiscard]] double Tolerance() const { return kAsGood * static_cast<double>(region_.rim.size()); }
  [[nodiscard]] double DepthOf(SegmentIndex s) const { return CentreDepth(view_.planes[s], segments_.centers[s]); }

  // Segments at the edge hold pixels of what is behind.
  [[nodiscard]] std::vector<PixelPosition> OfItsColour(std::vector<PixelPosition> pixels) const {
    std::array<double, 4> mean{};
    for (const auto& [x, y] : pixels)
      for (std::size_t i = 0; i < 4; ++i) mean[i] += fit_.own()(x, y)[i];
    for (double& value : mean) value /= static_cast<double>(pixels.size());
    std::erase_if(pixels, [&](const PixelPosition& p) {
      double difference = 0;
      for (std::size_t i = 0; i < 4; ++i) difference += std::abs(fit_.own()(p.x, p.y)[i] - mean[i]);
      return difference > kAlike;
    });
    return pixels;
  }

  // What mixes its colours with those of something nearer says nothing of the region.
  [[nodiscard]] std::vector<PixelPosition> AwayFromOccluders(std::vector<PixelPosition> pixels) const {
    std::vector<double> around;
    for (const SegmentIndex t : region_.beside) around.push_back(DepthOf(t));
    const double bound = FarSide(around) + kNearer;
    if (std::none_of(around.begin(), around.end(), [&](double u) { return u > bound; })) return pixels;
    std::vector<std::uint8_t> occludes(segments_.centers.size());
    for (const SegmentIndex t : region_.beside) occludes[t] = DepthOf(t) > bound ? 1 : 0;
    const Grid<SegmentIndex>& labels = segments_.labels;
    std::erase_if(pixels, [&](const PixelPosition& p) {
      for (int y = std::max(0, p.y - kBesideOccluder); y <= std::min(labels.height() - 1, p.y + kBesideOccluder); ++y)
        for (int x = std::max(0, p.x - kBesideOccluder); x <= std::min(labels.width() - 1, p.x + kBesideOccluder); ++x)
          if (occludes[labels(x, y)] != 0) return true;
      return false;
    });
    return pixels;
  }

  // The planes on and behind the rim, some near the one through the rim's far side, and those that the region has; the
  // farthest first.
  [[nodiscard]] std::vector<Candidate> Candidates() const {
    std::vector<Candidate> candidates;
    const auto add = [&](const SlantedPlane& plane) {
      candidates.push_back({.plane = plane, .u = plane.At(center_x_, center_y_), .support = 0, .fit = {}});
    };
    const auto offer = [&](const SlantedPlane& plane) {
      const double u = plane.At(center_x_, center_y_);
      const auto close = [&](const Candidate& other) { return std::abs(other.u - u) < kDistinct; };
      if (std::none_of(candidates.begin(), candidates.end(), close)) add(plane);
    };
    for (const SegmentIndex t : region_.rim) offer(view_.planes[t]);
    for (const SegmentIndex t : region_.behind) offer(view_.planes[t]);
    for (const SegmentIndex s : region_.segments) offer(view_.planes[s]);
    if (const auto fit = FitToRim()) {
      for (int move = -kMoves; move <= kMoves; ++move)
        add({fit->a, fit->b, static_cast<float>(fit->c + move * kDistinct)});
    }
    for (Candidate& candidate : candidates) {
      for (const SegmentIndex t : region_.rim) {
        const double gap = CentreDepth(candidate.plane, segments_.centers[t]) - DepthOf(t);
        candidate.support += std::abs(gap) < kSupports ? 1 : 0;
      }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.u < b.u; });
    return candidates;
  }

  // Through its far side.
  [[nodiscard]] std::optional<SlantedPlane> FitToRim() const {
    std::vector<double> depths;
    for (const SegmentIndex t : region_.rim) depths.push_back(DepthOf(t));
    const double bound = FarSide(depths) + kNearer;
    std::vector<DepthPoint> points;
    for (const SegmentIndex t : region_.rim) {
      const auto [x, y] = segments_.centers[t];
      const double u = DepthOf(t);
      if (u <= bound) points.push_back({static_cast<double>(x), static_cast<double>(y), u});
    }
    return FitPlane(points, center_x_, center_y_);
  }

  [[nodiscard]] std::size_t Step() const { return std::max<std::size_t>(1, pixels_.size() / kManyPixels); }

  // `depth_at`: u of a pixel. The cost is the region's.
  template <typename Depth>
  [[nodiscard]] Judgement Judge(const Depth& depth_at) const {
    Judgement judgement = fit_.Judge(judged_, depth_at);
    // Else the plane that moves most of the region out of sight would cost least.
    if (judgement.seen > 0) judgement.cost *= static_cast<double>(pixels_.size()) / static_cast<double>(judgement.seen);
    return judgement;
  }

  // How much worse `a` fits than `b`, by the pixels that are seen on both: the one that is farther may be hidden where
  // it does not fit. Misfits of the region, summed.
  [[nodiscard]] double Excess(const Judgement& a, const Judgement& b) const {
    return fit_.Excess(a, b) * static_cast<double>(Step());
  }

  // Whether the prior is to be preferred to `best`.
  [[nodiscard]] bool TakesPrior(const Judgement& best) const {
    if (prior_ == nullptr) return false;
    std::size_t says = 0;
    double trust = 0;
    for (const SegmentIndex s : region_.segments) {
      says += prior_->Says(s) ? 1 : 0;
      trust += prior_->trust[s];
    }
    const auto count = static_cast<double>(region_.segments.size());
    if (static_cast<double>(says) < kLeastSaid * count) return false;
    const Judgement fit = Judge([this](int x, int y) {
      const SegmentIndex s = segments_.labels(x, y);
      return prior_->Says(s) ? prior_->planes[s].At(x, y) : view_.At(x, y);
    });
    return trust / count >= kTrusted ? Excess(fit, best) <= Tolerance() : Excess(best, fit) > Tolerance();
  }

  [[nodiscard]] bool IsSupported(const Candidate& c) const {
    return static_cast<double>(c.support) >= kLeastSupport * static_cast<double>(region_.rim.size());
  }
  [[nodiscard]] bool IsPossible(const Candidate& c) const {
    return 1 - static_cast<double>(c.fit.seen) / static_cast<double>(judged_.size()) < kMostUnseen;
  }

  // Returns the possible one of least cost, the farthest of several; null: none is possible. Only its misfits and those
  // of supported ones, of which there are few, are kept: of a rim with many depths there may be a thousand candidates.
  const Candidate* JudgeAll(std::vector<Candidate>& candidates) const {
    Candidate* best = nullptr;
    for (Candidate& c : candidates) {
      c.fit = Judge([&](int x, int y) { return c.plane.At(x, y); });
      Candidate* other = &c;
      if (IsPossible(c) && (best == nullptr || c.fit.cost < best->fit.cost)) other = std::exchange(best, &c);
      if (other != nullptr && !IsSupported(*other)) other->fit.misfits = {};
    }
    return best;
  }

  [[nodiscard]] const Candidate& Choose(const std::vector<Candidate>& candidates, const Candidate& best) const {
    const Candidate* chosen = nullptr;
    for (const Candidate& c : candidates) {
      if (!IsPossible(c) || !IsSupported(c) || Excess(c.fit, best.fit) > Tolerance()) continue;
      const auto rank = [](const Candidate& of) { return std::pair(of.support, -of.fit.cost); };
      if (chosen == nullptr || (c.u <= chosen->u + kNearer && rank(c) > rank(*chosen))) chosen = &c;
    }
    return chosen != nullptr ? *chosen : best;
  }

  [[nodiscard]] bool IsPlate() const {
    std::vector<double> depths;
    for (const SegmentIndex s : region_.segments) depths.push_back(view_.planes[s].At(center_x_, center_y_));
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    const double median = *middle;
    const auto same =
        std::count_if(depths.begin(), depths.end(), [&](double u) { return std::abs(u - median) < kDistinct; });
    return static_cast<double>(same) >= kPlate * static_cast<double>(depths.size());
  }

  RegionFit fit_;
  const SegmentMap& segments_;
  const PlainRegion& region_;
  const PriorField* prior_;
  const RefinedView& view_;
  std::vector<PixelPosition> pixels_;  // of its own colour, away from what is nearer
  std::vector<PixelPosition> judged_;  // of these each Step()th
  double center_x_ = 0;
  double center_y_ = 0;
};

}  // namespace

void DecidePlainRegions(const PictureColours& own, const SegmentMap& segments, std::span<const PlainRegion> regions,
                        std::span<const OtherView> others, const PriorField* prior, RefinedView& view,
                        const std::stop_token& stop, int threads) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> region_of(segments.centers.size(), kNone);
  for (std::size_t r = 0; r < regions.size(); ++r)
    for (const SegmentIndex s : regions[r].segments) region_of[s] = r;
  std::vector<std::vector<PixelPosition>> pixels(regions.size());
  for (int y = 0; y < segments.labels.height(); ++y) {
    for (int x = 0; x < segments.labels.width(); ++x) {
      const std::size_t region = region_of[segments.labels(x, y)];
      if (region != kNone) pixels[region].push_back({x, y});
    }
  }
  const RefinedView before = view;  // so that the order of regions changes nothing
  // Regions share no segment, so threads decide each by itself; the largest, which take longest, first.
  std::vector<std::size_t> by_size(regions.size());
  std::iota(by_size.begin(), by_size.end(), std::size_t{0});
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](std::size_t a, std::size_t b) { return pixels[a].size() > pixels[b].size(); });
  ParallelFor(regions.size(), threads, [&](std::size_t i) {
    if (stop.stop_requested()) return;
    const std::size_t r = by_size[i];
    Decision decision(own, segments, regions[r], others, prior, before);
    const auto choice = decision.Make(pixels[r]);
    if (choice) {
      for (const SegmentIndex s : regions[r].segments) {
        if (!choice->prior) view.planes[s] = choice->plane;
        if (choice->prior && prior->Says(s)) view.planes[s] = prior->planes[s];
      }
      if (choice->prior) return;
    }
    const std::vector<SlantedPlane>& planes = view.planes;
    for (const RegionPart& part :
         FindNearerParts(RegionFit(own, others), segments, regions[r].segments, pixels[r], decision.judged(), planes)) {
      for (const SegmentIndex s : part.segments) view.planes[s] = part.plane;
    }
  });
}

}  // namespace depthfarm
