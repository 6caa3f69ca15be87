#include "worker/refinement/pixel_choice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "worker/refinement/colour_weight.h"
#include "worker/refinement/jump_band.h"
#include "worker/refinement/known_costs.h"
#include "worker/refinement/patch_cost.h"

namespace depthfarm {
namespace {

constexpr int kReach = 2;           // candidates come from as far, in each pass
constexpr int kMostPasses = 40;     // usually nothing is left to do before; two choices may swap for ever
constexpr double kDistinct = 0.15;  // pixels of u between candidates
constexpr std::size_t kMaxCandidates = 5;
constexpr std::size_t kUsualCandidates = 3;  // of a pixel that has a choice; room for more is made
constexpr std::size_t kUsualCosts = 5;
constexpr int kSweeps = 3;
constexpr int kBandsOfThread = 4;   // rows differ in what there is to do
constexpr int kFewestRows = 16;     // of a band
constexpr double kPriorCost = 0.3;  // of rho, for a plane that the prior speaks against
constexpr double kPriorScale = 1;   // pixels of u at which it does so in full
constexpr double kPairCost = 0.05;  // of rho, for neighbours on different surfaces
constexpr double kPairScale = 0.5;  // pixels of u at which they are that

constexpr std::array<std::pair<int, int>, 4> kFourNeighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
constexpr std::array<std::pair<int, int>, 8> kEightDirections{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};

// Rows [top, bottom).
struct Rows {
  int top = 0;
  int bottom = 0;
};

// A plane that a pixel may take.
struct Candidate {
  double u = 0;  // here
  double cost = 0;
  PlaneIndex plane = 0;
  KnownCosts::Entry entry = 0;  // of the cost, in the band's
};

// A pixel with more than one candidate; the first is the plane that it has.
struct Choice {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint32_t first = 0;  // of Choices::candidates
  std::uint32_t count = 0;
};

struct Choices {
  std::vector<Choice> all;
  std::vector<Candidate> candidates;

  [[nodiscard]] std::span<const Candidate> Of(const Choice& choice) const {
    return std::span(candidates).subspan(choice.first, choice.count);
  }
};

// What is found of some rows of the picture.
struct Band {
  Rows rows;
  KnownCosts known;  // of all passes: planes and maps stay, only who has which plane changes; y from the band's top
  Choices choices;   // of a pass
  std::vector<std::uint32_t> group_of_plane;  // FillCosts': 1 + the group's number; else 0
};

// As many as keep the threads busy.
std::vector<Band> RowBands(int width, int height, int threads) {
  const int most = threads > 1 ? std::max(1, height / kFewestRows) : 1;
  const int count = std::min(threads * kBandsOfThread, most);
  std::vector<Band> bands;
  for (int i = 0; i < count; ++i) {
    const Rows rows{height * i / count, height * (i + 1) / count};
    bands.push_back(
        {.rows = rows, .known = KnownCosts(width, rows.bottom - rows.top), .choices = {}, .group_of_plane = {}});
  }
  return bands;
}

// Finds the planes around pixels.
class Surroundings {
 public:
  explicit Surroundings(const RefinedView& view) : view_(view) {
    std::size_t i = 0;
    for (int d = 1; d <= kReach; ++d)
      for (const auto& [dx, dy] : kEightDirections)
        ways_[i++] = d * (dy * std::ptrdiff_t{view.plane_of_pixel.width()} + dx);
  }

  // Where the pixels around are all in the picture.
  [[nodiscard]] bool Whole(int x, int y) const {
    const Grid<PlaneIndex>& planes = view_.plane_of_pixel;
    return x >= kReach && y >= kReach && x + kReach < planes.width() && y + kReach < planes.height();
  }

  // Of each pixel from (x, y) to the right: the ways (one bit each) to pixels around that have another plane. All are
  // Whole.
  void FindOthers(int x, int y, std::span<std::uint32_t> others) const {
    const PlaneIndex* const here = view_.plane_of_pixel.row(y) + x;
    std::fill(others.begin(), others.end(), 0U);
    for (std::size_t way = 0; way < kNumWays; ++way) {
      const PlaneIndex* const there = here + ways_[way];
      const std::uint32_t bit = 1U << way;
      for (std::size_t i = 0; i < others.size(); ++i) others[i] |= there[i] != here[i] ? bit : 0U;
    }
  }

  // How many candidates there are at a pixel, and what they are but for their costs. `others`: of FindOthers where it
  // is Whole.
  std::size_t CandidatesAt(int x, int y, std::uint32_t others,
                           std::array<Candidate, kMaxCandidates>& candidates) const {
    std::size_t count = 0;
    const auto offer = [&](PlaneIndex plane) {
      const double u = view_.planes[plane].At(x, y);
      for (std::size_t i = 0; i < count; ++i)
        if (std::abs(candidates[i].u - u) <= kDistinct) return;
      candidates[count++] = {.u = u, .cost = 0, .plane = plane, .entry = 0};
    };
    const Grid<PlaneIndex>& planes = view_.plane_of_pixel;
    const PlaneIndex* const here = planes.row(y) + x;
    offer(*here);
    if (Whole(x, y)) {
      std::array<PlaneIndex, kNumWays> there{};
      for (std::size_t way = 0; way < kNumWays; ++way) there[way] = here[ways_[way]];
      while (others != 0 && count < kMaxCandidates) {
        const PlaneIndex plane = there[static_cast<std::size_t>(std::countr_zero(others))];
        std::uint32_t same = 0;
        for (std::size_t way = 0; way < kNumWays; ++way) same |= there[way] == plane ? 1U << way : 0U;
        others &= ~same;
        offer(plane);
      }
      return count;
    }
    // A plane that is offered again is like itself.
    for (int d = 1; d <= kReach; ++d) {
      for (const auto& [dx, dy] : kEightDirections)
        if (count < kMaxCandidates && planes.Contains(x + d * dx, y + d * dy)) offer(planes(x + d * dx, y + d * dy));
    }
    return count;
  }

 private:
  static constexpr std::size_t kNumWays = kReach * kEightDirections.size();

  const RefinedView& view_;
  std::array<std::ptrdiff_t, kNumWays> ways_{};  // to the pixels around, in the order in which they are asked
};

// The entries from `first` on, those of a plane one after the other and in their order. `group_of_plane`: all 0, as it
// is left; late passes have few entries, so that its size must not count.
std::vector<KnownCosts::Entry> GroupedByPlane(const KnownCosts& known, std::size_t first, std::size_t num_planes,
                                              std::vector<std::uint32_t>& group_of_plane) {
  group_of_plane.resize(num_planes);
  std::vector<PlaneIndex> planes;   // of the groups
  std::vector<std::uint32_t> next;  // entry of each group, where it goes
  for (std::size_t i = first; i < known.size(); ++i) {
    const PlaneIndex plane = known[static_cast<KnownCosts::Entry>(i)].plane;
    std::uint32_t& group = group_of_plane[plane];
    if (group == 0) {
      planes.push_back(plane);
      next.push_back(0);
      group = static_cast<std::uint32_t>(planes.size());
    }
    ++next[group - 1];
  }
  std::exclusive_scan(next.begin(), next.end(), next.begin(), 0U);
  std::vector<KnownCosts::Entry> grouped(known.size() - first);
  for (std::size_t i = first; i < known.size(); ++i) {
    const auto entry = static_cast<KnownCosts::Entry>(i);
    grouped[next[group_of_plane[known[entry].plane] - 1]++] = entry;
  }
  for (const PlaneIndex plane : planes) group_of_plane[plane] = 0;
  return grouped;
}

// Sets the costs of the band's entries from `first` on, and of the candidates that have them. Plane by plane and row by
// row, as PatchCost asks for.
void FillCosts(const RefinedView& view, std::size_t first, PatchCost& cost, Band& band, const std::stop_token& stop) {
  KnownCosts& known = band.known;
  if (first == known.size()) return;
  const std::vector<KnownCosts::Entry> by_plane = GroupedByPlane(known, first, view.planes.size(), band.group_of_plane);
  std::vector<PixelPosition> pixels;
  std::vector<double> costs;
  for (std::size_t begin = 0, end = 0; begin < by_plane.size() && !stop.stop_requested(); begin = end) {
    const PlaneIndex plane = known[by_plane[begin]].plane;
    pixels.clear();
    for (; end < by_plane.size() && known[by_plane[end]].plane == plane; ++end) {
      const KnownCosts::Place place = known.PlaceOf(by_plane[end]);
      pixels.push_back({place.x, band.rows.top + place.y});
    }
    costs.resize(pixels.size());
    cost.Costs(view.planes[plane], pixels, costs);
    for (std::size_t i = 0; i < costs.size(); ++i) known.Set(by_plane[begin + i], costs[i]);
  }
  for (Candidate& candidate : band.choices.candidates)
    if (candidate.entry >= first) candidate.cost = known[candidate.entry].value;
}

// What decides between the planes of a pixel.
class Chooser {
 public:
  Chooser(const YcbcrImage& own, const Grid<SegmentIndex>& segments, const PriorField* prior)
      : own_(own), segments_(segments), prior_(prior) {}

  [[nodiscard]] PlaneIndex Best(const RefinedView& view, const Choice& choice,
                                std::span<const Candidate> candidates) const {
    // Of the four neighbours, side by side; one out of the picture has no link.
    std::array<double, 4> links{};
    std::array<double, 4> beside{};
    for (std::size_t i = 0; i < kFourNeighbours.size(); ++i) {
      const int x = choice.x + kFourNeighbours[i].first;
      const int y = choice.y + kFourNeighbours[i].second;
      if (!own_.Contains(x, y)) continue;
      links[i] = kPairCost * ColourWeight(own_(choice.x, choice.y), own_(x, y));
      beside[i] = view.At(x, y);
    }
    const std::optional<double> prior = prior_ != nullptr ? prior_->At(choice.x, choice.y) : std::nullopt;
    const double trusted = prior ? kPriorCost * prior_->trust[segments_(choice.x, choice.y)] : 0;
    std::size_t best = 0;
    double least = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      double cost = candidates[i].cost;
      if (prior) cost += trusted * std::min(1.0, std::abs(candidates[i].u - *prior) / kPriorScale);
      std::array<double, 4> apart{};
      for (std::size_t n = 0; n < apart.size(); ++n) apart[n] = std::abs(beside[n] - candidates[i].u) / kPairScale;
      for (std::size_t n = 0; n < apart.size(); ++n) cost += links[n] * std::min(apart[n], 1.0);
      if (i != 0 && cost >= least) continue;
      best = i;
      least = cost;
    }
    return candidates[best].plane;
  }

 private:
  const YcbcrImage& own_;
  const Grid<SegmentIndex>& segments_;
  const PriorField* prior_;
};

// The first pixel of a row from x on that has this mark; the width if there is none. Late passes have few.
int NextMarked(const Grid<std::uint8_t>& marked, int mark, int x, int y) {
  const std::uint8_t* const row = marked.row(y);
  const void* const found = std::memchr(row + x, mark, static_cast<std::size_t>(marked.width() - x));
  return found == nullptr ? marked.width() : static_cast<int>(static_cast<const std::uint8_t*>(found) - row);
}

// Finds the band's choices at the marked pixels that have one and may move.
void FindChoices(const Grid<std::uint8_t>& marked, const Grid<SegmentIndex>& segments, const RefinedView& view,
                 Band& band) {
  Choices& choices = band.choices;
  choices.all.clear();
  choices.candidates.clear();
  const Surroundings surroundings(view);
  std::array<Candidate, kMaxCandidates> candidates{};
  const auto add = [&](int x, int y, std::uint32_t others) {
    if (view.kept[segments(x, y)] != 0) return;
    const std::size_t count = surroundings.CandidatesAt(x, y, others, candidates);
    if (count < 2) return;
    choices.all.push_back({.x = static_cast<std::uint16_t>(x),
                           .y = static_cast<std::uint16_t>(y),
                           .first = static_cast<std::uint32_t>(choices.candidates.size()),
                           .count = static_cast<std::uint32_t>(count)});
    for (Candidate& candidate : std::span(candidates).first(count)) {
      candidate.entry = band.known.EntryOf(x, y - band.rows.top, candidate.plane);
      candidate.cost = band.known[candidate.entry].value;
      choices.candidates.push_back(candidate);
    }
  };
  std::vector<std::uint32_t> others;
  for (int y = band.rows.top; y < band.rows.bottom; ++y) {
    int end = 0;
    for (int x = NextMarked(marked, 1, 0, y); x < marked.width(); x = NextMarked(marked, 1, end, y)) {
      end = NextMarked(marked, 0, x, y);
      for (; x < end && !surroundings.Whole(x, y); ++x) add(x, y, 0);
      int last = x;
      while (last < end && surroundings.Whole(last, y)) ++last;
      others.resize(static_cast<std::size_t>(last - x));
      surroundings.FindOthers(x, y, others);
      for (const std::uint32_t of_pixel : others) {
        if (of_pixel != 0) add(x, y, of_pixel);
        ++x;
      }
      for (; x < end; ++x) add(x, y, 0);
    }
  }
}

// Chooses in a few sweeps over the pixels. `stale` is 1 at each of them: from the second sweep on only those are asked
// again of which a neighbour has changed.
void Sweep(const Chooser& chooser, std::span<const Band> bands, Grid<std::uint8_t>& stale, RefinedView& view) {
  const auto choose = [&](const Band& band, const Choice& choice) {
    if (stale(choice.x, choice.y) == 0) return;
    stale(choice.x, choice.y) = 0;
    PlaneIndex& now = view.plane_of_pixel(choice.x, choice.y);
    const PlaneIndex best = chooser.Best(view, choice, band.choices.Of(choice));
    if (best == now) return;
    now = best;
    for (const auto& [dx, dy] : kFourNeighbours)
      if (stale.Contains(choice.x + dx, choice.y + dy)) stale(choice.x + dx, choice.y + dy) = 1;
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const Band& band : bands)
      for (const Choice& choice : band.choices.all) choose(band, choice);
  }
}

// Of the square around (x0, y0) what is in the picture.
void MarkAround(int x0, int y0, int radius, Grid<std::uint8_t>& marked) {
  for (int y = std::max(0, y0 - radius); y <= std::min(marked.height() - 1, y0 + radius); ++y)
    for (int x = std::max(0, x0 - radius); x <= std::min(marked.width() - 1, x0 + radius); ++x) marked(x, y) = 1;
}

// Marks the pixels that may have got another candidate: those near one that has another plane than it had.
void MarkNearChanges(std::span<const Band> bands, const RefinedView& view, Grid<std::uint8_t>& near) {
  std::fill(near.values().begin(), near.values().end(), std::uint8_t{0});
  for (const Band& band : bands) {
    for (const Choice& choice : band.choices.all) {
      if (view.plane_of_pixel(choice.x, choice.y) != band.choices.candidates[choice.first].plane)
        MarkAround(choice.x, choice.y, kReach, near);
    }
  }
}

}  // namespace

void ChoosePlanes(const YcbcrImage& own, const Grid<SegmentIndex>& segments, const InverseDepthMap& map,
                  std::span<const OtherView> others, const PriorField* prior, RefinedView& view,
                  const std::stop_token& stop, int threads) {
  const Chooser chooser(own, segments, prior);
  Grid<std::uint8_t> open = JumpBand(map, threads);
  std::vector<Band> bands = RowBands(own.width(), own.height(), threads);
  const auto for_bands = [&](const auto& each) {
    ParallelFor(bands.size(), threads, [&](std::size_t i) { each(bands[i]); });
  };
  // Reserved for what is usual: where all of a picture is near jumps, lists grow as they must.
  for_bands([&](Band& band) {
    const std::size_t pixels =
        static_cast<std::size_t>(band.rows.bottom - band.rows.top) * static_cast<std::size_t>(own.width());
    const std::uint8_t* const first = open.row(band.rows.top);
    const auto marked = static_cast<std::size_t>(std::count(first, first + pixels, 1));
    const std::size_t usual = std::min(marked, bands.size() > 1 ? pixels : pixels / 4);
    band.choices.all.reserve(usual);
    band.choices.candidates.reserve(kUsualCandidates * usual);
    band.known.Reserve(kUsualCosts * usual);
  });
  for (int pass = 0; pass < kMostPasses && !stop.stop_requested(); ++pass) {
    for_bands([&](Band& band) {
      const std::size_t known_before = band.known.size();
      FindChoices(open, segments, view, band);
      PatchCost cost(own, others);
      FillCosts(view, known_before, cost, band, stop);
    });
    if (stop.stop_requested()) return;
    if (std::all_of(bands.begin(), bands.end(), [](const Band& band) { return band.choices.all.empty(); })) return;
    Sweep(chooser, bands, open, view);
    MarkNearChanges(bands, view, open);
  }
}

}  // namespace depthfarm
