#include "worker/segmentation/describe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/worker/segmentation/test_pictures.h"
#include "worker/segmentation/analysis.h"
#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

Grid<SegmentIndex> Labels(int width, std::vector<SegmentIndex> values) {
  Grid<SegmentIndex> labels(width, static_cast<int>(values.size()) / width);
  labels.values() = std::move(values);
  return labels;
}

class DescribeProperty : public testing::TestWithParam<NamedPicture> {
 protected:
  ViewAnalysis Analyse() const { return AnalyseView(GetParam().picture, GetParam().num_segments, 5).value(); }
};
INSTANTIATE_TEST_SUITE_P(Pictures, DescribeProperty, testing::ValuesIn(PropertyPictures()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST_P(DescribeProperty, MeansAreTheNearest64thOfAGreyLevel) {
  const ViewAnalysis analysis = Analyse();
  const YcbcrImage& picture = analysis.picture;
  const SegmentMap& segments = analysis.segments;
  std::vector<double> luma(segments.means.size()), cb(luma), cr(luma), pixels(luma);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const SegmentIndex label = segments.labels.values()[i];
    luma[label] += picture.values()[i].y;
    cb[label] += picture.values()[i].cb;
    cr[label] += picture.values()[i].cr;
    pixels[label] += 1;
  }
  for (std::size_t s = 0; s < pixels.size(); ++s) {
    EXPECT_LE(std::abs(64 * luma[s] / pixels[s] - segments.means[s].y), 0.5 + 1e-9);
    EXPECT_LE(std::abs(64 * cb[s] / pixels[s] - segments.means[s].cb), 0.5 + 1e-9);
    EXPECT_LE(std::abs(64 * cr[s] / pixels[s] - segments.means[s].cr), 0.5 + 1e-9);
  }
}

// By all pixels of each segment.
void ExpectCentersNearestToCentroids(const SegmentMap& segments) {
  const Grid<SegmentIndex>& labels = segments.labels;
  for (std::size_t s = 0; s < segments.centers.size(); ++s) {
    std::int64_t n = 0, sum_x = 0, sum_y = 0;
    for (int y = 0; y < labels.height(); ++y) {
      for (int x = 0; x < labels.width(); ++x) {
        if (labels(x, y) != s) continue;
        ++n, sum_x += x, sum_y += y;
      }
    }
    PixelPosition best;
    std::int64_t best_distance = std::numeric_limits<std::int64_t>::max();
    for (int y = 0; y < labels.height(); ++y) {
      for (int x = 0; x < labels.width(); ++x) {
        if (labels(x, y) != s) continue;
        const std::int64_t distance = (n * x - sum_x) * (n * x - sum_x) + (n * y - sum_y) * (n * y - sum_y);
        if (distance < best_distance) best_distance = distance, best = {x, y};
      }
    }
    EXPECT_EQ(segments.centers[s], best) << "segment " << s;
  }
}

TEST_P(DescribeProperty, CentersAreTheFirstOfTheOwnPixelsNearestToTheCentroid) {
  ExpectCentersNearestToCentroids(Analyse().segments);
}

TEST_P(DescribeProperty, AdjacencyIsTheSortedSetOfPairsThatShareAPixelEdge) {
  const SegmentMap segments = Analyse().segments;
  const Grid<SegmentIndex>& labels = segments.labels;
  std::set<std::pair<SegmentIndex, SegmentIndex>> expected;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (labels.Contains(x + dx, y + dy) && labels(x, y) < labels(x + dx, y + dy)) {
          expected.insert({labels(x, y), labels(x + dx, y + dy)});
        }
      }
    }
  }
  std::vector<SegmentMap::Adjacency> sorted;
  for (const auto& [first, second] : expected) sorted.push_back({first, second});
  EXPECT_EQ(segments.adjacency, sorted);
}

TEST(DescribeSegments, RoundsHalvesOfA64thUp) {
  YcbcrImage picture(128, 1, Ycbcr{10, 20, 30});
  picture(0, 0) = {11, 20, 29};  // means 10 + 1/128 and 30 - 1/128: half a 64th above and below
  for (int x = 0; x < 32; ++x) picture(x, 0).matte = kForegroundMatte;
  const SegmentMap map = DescribeSegments(Grid<SegmentIndex>(128, 1, 0), picture);
  EXPECT_EQ(map.means.front(), (MeanColor{.y = 641, .cb = 1280, .cr = 1920, .matte = 640}));
}

TEST(DescribeSegments, CenterLiesInsideARing) {
  const SegmentMap map = DescribeSegments(Labels(3, {0, 0, 0, 0, 1, 0, 0, 0, 0}), YcbcrImage(3, 3));
  EXPECT_EQ(map.centers[0], (PixelPosition{1, 0}));  // four pixels are equally near: the first row by row
  EXPECT_EQ(map.centers[1], (PixelPosition{1, 1}));
}

// Rings around a point, wider and wider, cut into 1 to 8 pieces: pixels and centroids lie 0 to 60 pixels apart.
TEST(DescribeSegments, FindsCentersOfRingsAndOfTheirPieces) {
  constexpr int kSide = 127;
  for (int pieces = 1; pieces <= 8; ++pieces) {
    Grid<SegmentIndex> labels(kSide, kSide);
    std::map<int, SegmentIndex> number_of;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double dx = x - 60.25;
        const double dy = y - 63;
        const int ring = static_cast<int>(std::sqrt(std::hypot(dx, dy)));
        const double turn = (std::atan2(dy, dx) / std::numbers::pi + 1) / 2;
        const int piece = std::min(pieces - 1, static_cast<int>(turn * pieces));
        labels(x, y) = number_of.try_emplace(16 * ring + piece, number_of.size()).first->second;
      }
    }
    SCOPED_TRACE(std::to_string(pieces) + " pieces");
    ExpectCentersNearestToCentroids(DescribeSegments(labels, YcbcrImage(kSide, kSide)));
  }
}

TEST(DescribeSegments, SegmentsThatTouchAtACornerAreNotAdjacent) {
  const SegmentMap map = DescribeSegments(Labels(2, {0, 1, 2, 3}), YcbcrImage(2, 2));
  EXPECT_EQ(map.adjacency, (std::vector<SegmentMap::Adjacency>{{0, 1}, {0, 2}, {1, 3}, {2, 3}}));
}

// The longest side with all pixels in one segment at its far end: the largest terms of the centroid's distance, by
// side.
TEST(DescribeSegments, FindsTheCenterOfTheLongestRow) {
  const SegmentMap map =
      DescribeSegments(Grid<SegmentIndex>(kMaxPictureSide, 3, 0), YcbcrImage(kMaxPictureSide, 3, Ycbcr{255, 255, 255}));
  EXPECT_EQ(map.centers[0], (PixelPosition{kMaxPictureSide / 2 - 1, 1}));
  EXPECT_EQ(map.means[0], (MeanColor{255 * 64, 255 * 64, 255 * 64}));
}

TEST(AnalyseView, TellsWhySegmentingFailed) {
  EXPECT_EQ(AnalyseView(YcbcrImage(), 1, 5).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
