#include "worker/segmentation/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace depthfarm {
namespace {

struct Sums {
  std::int64_t pixels = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t luma = 0;
  std::int64_t cb = 0;
  std::int64_t cr = 0;
  std::int64_t matte = 0;

  // Orders positions by distance from the centroid: the squared distance less what all positions share, over `pixels`,
  //   (n x - X)^2 + (n y - Y)^2 = n * [n (x^2 + y^2) - 2 (x X + y Y)] + X^2 + Y^2.
  // With sides up to 2^14 every term stays below 2^58.
  [[nodiscard]] std::int64_t CentroidDistance(std::int64_t px, std::int64_t py) const {
    return pixels * (px * px + py * py) - 2 * (px * x + py * y);
  }
};

std::vector<Sums> SumSegments(const Grid<SegmentIndex>& labels, const YcbcrImage& picture) {
  const SegmentIndex last = *std::max_element(labels.values().begin(), labels.values().end());
  std::vector<Sums> sums(static_cast<std::size_t>(last) + 1);
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      Sums& segment = sums[labels(x, y)];
      const Ycbcr& color = picture(x, y);
      ++segment.pixels;
      segment.x += x;
      segment.y += y;
      segment.luma += color.y;
      segment.cb += color.cb;
      segment.cr += color.cr;
      segment.matte += color.matte;
    }
  }
  return sums;
}

std::int32_t ScaledMean(std::int64_t sum, std::int64_t pixels) {
  return static_cast<std::int32_t>((2 * kMeanColorScale * sum + pixels) / (2 * pixels));
}

// The pixel of a segment that is nearest to its centroid, the first of several: in the first of growing squares around
// the centroid that has a pixel nearer than all outside of it. Nothing if even the largest has none.
std::optional<PixelPosition> CenterNearCentroid(const Grid<SegmentIndex>& labels, SegmentIndex segment,
                                                const Sums& sums) {
  constexpr int kLargestRadius = 7;
  constexpr double kSlack = 1e-3;  // far more than the centroid is rounded by
  const double centroid_x = static_cast<double>(sums.x) / static_cast<double>(sums.pixels);
  const double centroid_y = static_cast<double>(sums.y) / static_cast<double>(sums.pixels);
  const int middle_x = static_cast<int>(std::lround(centroid_x));
  const int middle_y = static_cast<int>(std::lround(centroid_y));
  for (int radius = 0; radius <= kLargestRadius; radius = 2 * radius + 1) {
    std::optional<PixelPosition> center;
    std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
    const int right = std::min(labels.width() - 1, middle_x + radius);
    const int bottom = std::min(labels.height() - 1, middle_y + radius);
    for (int y = std::max(0, middle_y - radius); y <= bottom; ++y) {
      for (int x = std::max(0, middle_x - radius); x <= right; ++x) {
        if (labels(x, y) != segment) continue;
        const std::int64_t distance = sums.CentroidDistance(x, y);
        if (distance >= nearest) continue;
        nearest = distance;
        center = {x, y};
      }
    }
    if (!center.has_value()) continue;
    const double outside = radius + 0.5 - kSlack;  // what is outside is as far at least
    const double dx = center->x - centroid_x;
    const double dy = center->y - centroid_y;
    if (dx * dx + dy * dy < outside * outside) return center;
  }
  return std::nullopt;
}

std::vector<PixelPosition> Centers(const Grid<SegmentIndex>& labels, const std::vector<Sums>& sums) {
  std::vector<PixelPosition> centers(sums.size());
  // Of segments that are far from their centroid, as rings are: all their pixels are looked at.
  std::vector<std::uint8_t> far(sums.size());
  for (SegmentIndex s = 0; s < sums.size(); ++s) {
    const std::optional<PixelPosition> near = CenterNearCentroid(labels, s, sums[s]);
    far[s] = near.has_value() ? 0 : 1;
    centers[s] = near.value_or(PixelPosition{});
  }
  if (std::find(far.begin(), far.end(), 1) == far.end()) return centers;
  std::vector<std::int64_t> nearest(sums.size(), std::numeric_limits<std::int64_t>::max());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const SegmentIndex label = labels(x, y);
      if (far[label] == 0) continue;
      const std::int64_t distance = sums[label].CentroidDistance(x, y);
      if (distance >= nearest[label]) continue;
      nearest[label] = distance;
      centers[label] = {x, y};
    }
  }
  return centers;
}

// The larger labels among the neighbours of each segment.
class Neighbours {
 public:
  explicit Neighbours(std::size_t num_segments) : of_(num_segments) {}

  // Two adjacent segments, as often as they are met. A pair is looked for without a branch: none could be foreseen.
  void Add(SegmentIndex a, SegmentIndex b) {
    const auto [first, second] = std::minmax(a, b);
    Larger& larger = of_[first];
    bool known = false;
    for (std::size_t i = 0; i < kUsual; ++i) known |= larger.labels[i] == second;
    if (larger.count == kUsual && !known) {
      others_.push_back({first, second});
      return;
    }
    larger.labels[larger.count] = second;
    larger.count += known ? 0 : 1;
  }

  // Each pair once, in order.
  [[nodiscard]] std::vector<SegmentMap::Adjacency> Sorted() {
    const auto in_order = [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first < b.first : a.second < b.second;
    };
    std::sort(others_.begin(), others_.end(), in_order);
    others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
    std::vector<SegmentMap::Adjacency> pairs;
    auto other = others_.begin();
    for (std::size_t segment = 0; segment < of_.size(); ++segment) {
      const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
      for (std::size_t i = 0; i < of_[segment].count; ++i)
        pairs.push_back({static_cast<SegmentIndex>(segment), of_[segment].labels[i]});
      for (; other != others_.end() && other->first == segment; ++other) pairs.push_back(*other);
      std::sort(pairs.begin() + begin, pairs.end(), in_order);
    }
    return pairs;
  }

 private:
  static constexpr std::size_t kUsual = 8;
  static constexpr SegmentIndex kNone = std::numeric_limits<SegmentIndex>::max();

  struct Larger {
    std::size_t count = 0;
    std::array<SegmentIndex, kUsual + 1> labels{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  };
  std::vector<Larger> of_;
  std::vector<SegmentMap::Adjacency> others_;  // of those with more, some twice
};

std::vector<SegmentMap::Adjacency> Adjacencies(const Grid<SegmentIndex>& labels, std::size_t num_segments) {
  Neighbours neighbours(num_segments);
  const auto width = static_cast<std::size_t>(labels.width());
  std::vector<std::size_t> at(width);  // where there are borders, found without a branch
  for (int y = 0; y < labels.height(); ++y) {
    const auto add_where = [&](const SegmentIndex* row, const SegmentIndex* beside, std::size_t count) {
      std::size_t found = 0;
      for (std::size_t x = 0; x < count; ++x) {
        at[found] = x;
        found += row[x] != beside[x] ? 1 : 0;
      }
      for (std::size_t i = 0; i < found; ++i) neighbours.Add(row[at[i]], beside[at[i]]);
    };
    const SegmentIndex* const row = labels.row(y);
    add_where(row, row + 1, width - 1);
    if (y + 1 < labels.height()) add_where(row, labels.row(y + 1), width);
  }
  return neighbours.Sorted();
}

}  // namespace

SegmentMap DescribeSegments(Grid<SegmentIndex> labels, const YcbcrImage& picture) {
  const std::vector<Sums> sums = SumSegments(labels, picture);
  SegmentMap map;
  map.centers = Centers(labels, sums);
  map.means.reserve(sums.size());
  for (const Sums& segment : sums) {
    map.means.push_back({.y = ScaledMean(segment.luma, segment.pixels),
                         .cb = ScaledMean(segment.cb, segment.pixels),
                         .cr = ScaledMean(segment.cr, segment.pixels),
                         .matte = ScaledMean(segment.matte, segment.pixels)});
  }
  map.adjacency = Adjacencies(labels, sums.size());
  map.labels = std::move(labels);
  return map;
}

}  // namespace depthfarm
