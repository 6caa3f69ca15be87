#include "worker/segmentation/describe.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
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

std::vector<PixelPosition> Centers(const Grid<SegmentIndex>& labels, const std::vector<Sums>& sums) {
  std::vector<PixelPosition> centers(sums.size());
  std::vector<std::int64_t> nearest(sums.size(), std::numeric_limits<std::int64_t>::max());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const SegmentIndex label = labels(x, y);
      const std::int64_t distance = sums[label].CentroidDistance(x, y);
      if (distance >= nearest[label]) continue;
      nearest[label] = distance;
      centers[label] = {x, y};
    }
  }
  return centers;
}

// Calls visit(smaller label, larger label) for each pair of 4-neighbour pixels of different segments.
template <typename Visit>
void ForEachBorder(const Grid<SegmentIndex>& labels, const Visit& visit) {
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const SegmentIndex label = labels(x, y);
      if (x + 1 < labels.width() && labels(x + 1, y) != label) {
        visit(std::min(label, labels(x + 1, y)), std::max(label, labels(x + 1, y)));
      }
      if (y + 1 < labels.height() && labels(x, y + 1) != label) {
        visit(std::min(label, labels(x, y + 1)), std::max(label, labels(x, y + 1)));
      }
    }
  }
}

// Borders are sorted by counting into a run per first segment; the runs are short.
std::vector<SegmentMap::Adjacency> Adjacencies(const Grid<SegmentIndex>& labels, std::size_t num_segments) {
  std::vector<std::size_t> begin(num_segments + 1, 0);
  ForEachBorder(labels, [&](SegmentIndex first, SegmentIndex) { ++begin[first + 1]; });
  for (std::size_t segment = 0; segment < num_segments; ++segment) begin[segment + 1] += begin[segment];
  std::vector<SegmentIndex> seconds(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  ForEachBorder(labels, [&](SegmentIndex first, SegmentIndex second) { seconds[next[first]++] = second; });

  std::vector<SegmentMap::Adjacency> adjacency;
  for (std::size_t segment = 0; segment < num_segments; ++segment) {
    const auto run = seconds.begin() + static_cast<std::ptrdiff_t>(begin[segment]);
    const auto run_end = seconds.begin() + static_cast<std::ptrdiff_t>(begin[segment + 1]);
    std::sort(run, run_end);
    const auto distinct_end = std::unique(run, run_end);
    for (auto second = run; second != distinct_end; ++second) {
      adjacency.push_back({static_cast<SegmentIndex>(segment), *second});
    }
  }
  return adjacency;
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
