#include "worker/refinement/plain_regions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <utility>

namespace depthfarm {
namespace {

constexpr double kPlain = 1.5;       // grey levels a pixel: root mean square of the gradient over all components
constexpr double kAlike = 12;        // grey levels, summed over the components, between neighbours of a region
constexpr double kAlikeAtEdge = 40;  // of a mixture at its edge, against the region's mean
constexpr double kSameDepth = 0.6;   // pixels of u
constexpr std::size_t kFewestSegments = 12;
constexpr int kSpread = 2;         // pixels
constexpr float kNothing = -1e9F;  // u of what hides nothing

constexpr std::int32_t kNoRegion = -1;

double Difference(const MeanColor& a, const MeanColor& b) {
  return static_cast<double>(L1Distance(a, b)) / kMeanColorScale;
}

class Regions {
 public:
  Regions(const SegmentMap& segments, std::span<const std::uint8_t> plain, const RefinedView& view)
      : segments_(segments), plain_(plain), view_(view), adjacent_(plain.size()), region_of_(plain.size(), kNoRegion) {
    for (const auto& [s, t] : segments.adjacency) {
      adjacent_[s].push_back(t);
      adjacent_[t].push_back(s);
    }
  }

  std::vector<PlainRegion> Find() {
    std::vector<PlainRegion> regions;
    for (SegmentIndex seed = 0; seed < plain_.size(); ++seed) {
      if (!MayGrow(seed)) continue;
      PlainRegion region{.segments = Grow(seed), .beside = {}, .rim = {}, .behind = {}};
      ++next_;
      if (region.segments.size() >= kFewestSegments) regions.push_back(std::move(region));
    }
    for (PlainRegion& region : regions) AddEdge(region);
    for (PlainRegion& region : regions) FindRim(region);
    std::erase_if(regions, [](const PlainRegion& region) { return region.rim.empty(); });
    return regions;
  }

 private:
  [[nodiscard]] bool MayGrow(SegmentIndex s) const {
    return plain_[s] != 0 && view_.kept[s] == 0 && region_of_[s] == kNoRegion;
  }

  std::vector<SegmentIndex> Grow(SegmentIndex seed) {
    std::vector<SegmentIndex> members{seed};
    region_of_[seed] = next_;
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (const SegmentIndex t : adjacent_[members[i]]) {
        if (!MayGrow(t) || Difference(segments_.means[members[i]], segments_.means[t]) > kAlike) continue;
        region_of_[t] = next_;
        members.push_back(t);
      }
    }
    return members;
  }

  void AddEdge(PlainRegion& region) {
    double y = 0, cb = 0, cr = 0, matte = 0;
    for (const SegmentIndex s : region.segments) {
      y += segments_.means[s].y;
      cb += segments_.means[s].cb;
      cr += segments_.means[s].cr;
      matte += segments_.means[s].matte;
    }
    const auto count = static_cast<double>(region.segments.size());
    const auto difference = [&](const MeanColor& c) {
      return (std::abs(y / count - c.y) + std::abs(cb / count - c.cb) + std::abs(cr / count - c.cr) +
              std::abs(matte / count - c.matte)) /
             kMeanColorScale;
    };
    for (std::size_t i = 0, end = region.segments.size(); i < end; ++i) {
      const SegmentIndex s = region.segments[i];
      for (const SegmentIndex t : adjacent_[s]) {
        if (region_of_[t] != kNoRegion || view_.kept[t] != 0 || difference(segments_.means[t]) > kAlikeAtEdge) continue;
        const auto [cx, cy] = segments_.centers[t];
        if (std::abs(view_.planes[t].At(cx, cy) - view_.planes[s].At(cx, cy)) > kSameDepth) continue;
        region_of_[t] = region_of_[s];
        region.segments.push_back(t);
      }
    }
  }

  void FindRim(PlainRegion& region) const {
    const std::int32_t own = region_of_[region.segments.front()];
    const auto known = [&](SegmentIndex s) { return region_of_[s] != own && (plain_[s] == 0 || view_.kept[s] != 0); };
    for (const SegmentIndex s : region.segments) {
      for (const SegmentIndex t : adjacent_[s]) {
        if (region_of_[t] != own) region.beside.push_back(t);
        if (!known(t)) continue;
        region.rim.push_back(t);
        std::copy_if(adjacent_[t].begin(), adjacent_[t].end(), std::back_inserter(region.behind), known);
      }
    }
  }

  const SegmentMap& segments_;
  std::span<const std::uint8_t> plain_;
  const RefinedView& view_;
  std::vector<std::vector<SegmentIndex>> adjacent_;
  std::vector<std::int32_t> region_of_;
  std::int32_t next_ = 0;
};

// Each value the largest of those up to kSpread away. `row` has kSpread more to either side.
void SpreadRow(std::span<const float> row, std::span<float> spread) {
  const float* const values = row.data();
  for (std::size_t x = 0; x < spread.size(); ++x) {
    float largest = values[x];
    for (std::size_t i = 1; i <= 2 * kSpread; ++i) largest = std::max(largest, values[x + i]);
    spread[x] = largest;
  }
}

std::int64_t SquaredDifference(const FineYcbcr& a, const FineYcbcr& b) {
  const auto squared = [](int p, int q) { return std::int64_t{p - q} * (p - q); };
  return squared(a.y, b.y) + squared(a.cb, b.cb) + squared(a.cr, b.cr) + squared(a.matte, b.matte);
}

}  // namespace

std::vector<std::uint8_t> PlainSegments(const FineImage& smoothed, const SegmentMap& segments) {
  constexpr double kUnits = 4.0 * kFineScale * kFineScale;  // a power of two: what is divided by it stays exact
  std::vector<std::uint8_t> plain(segments.centers.size());
  for (std::size_t s = 0; s < plain.size(); ++s) {
    const auto [cx, cy] = segments.centers[s];
    std::int64_t sum = 0;  // of squares, 1 / (2 kFineScale) grey levels; below 2^40
    int pixels = 0;
    for (int y = std::max(1, cy - 1); y <= std::min(smoothed.height() - 2, cy + 1); ++y) {
      for (int x = std::max(1, cx - 1); x <= std::min(smoothed.width() - 2, cx + 1); ++x) {
        sum += SquaredDifference(smoothed(x + 1, y), smoothed(x - 1, y)) +
               SquaredDifference(smoothed(x, y + 1), smoothed(x, y - 1));
        ++pixels;
      }
    }
    plain[s] = pixels > 0 && std::sqrt(static_cast<double>(sum) / kUnits / pixels) < kPlain ? 1 : 0;
  }
  return plain;
}

std::vector<PlainRegion> FindPlainRegions(const SegmentMap& segments, std::span<const std::uint8_t> plain,
                                          const RefinedView& view) {
  return Regions(segments, plain, view).Find();
}

InverseDepthMap Occluders(const InverseDepthMap& map, const Grid<SegmentIndex>& labels,
                          std::span<const std::uint8_t> plain) {
  const auto width = static_cast<std::size_t>(map.width());
  InverseDepthMap occluders(map.width(), map.height(), kNothing);
  std::vector<float> known(width + 2 * kSpread, kNothing);
  std::vector<float> spread(width);
  for (int y = 0; y < map.height(); ++y) {
    for (std::size_t x = 0; x < width; ++x)
      known[x + kSpread] = plain[labels.row(y)[x]] != 0 ? kNothing : map.row(y)[x];
    SpreadRow(known, spread);
    for (int to = std::max(0, y - kSpread); to <= std::min(map.height() - 1, y + kSpread); ++to) {
      float* const row = occluders.row(to);
      for (std::size_t x = 0; x < width; ++x) row[x] = std::max(row[x], spread[x]);
    }
  }
  return occluders;
}

}  // namespace depthfarm
