#include "worker/segmentation/still_segments.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/worker/segmentation/test_pictures.h"
#include "worker/segmentation/analysis.h"
#include "worker/segmentation/describe.h"
#include "worker/segmentation/snic.h"

namespace depthfarm {
namespace {

constexpr double kCompactness = 5;
constexpr int kThreshold = 3;

// Strips of 8 x 4 pixels, one below the other.
SegmentMap Strips(int count) {
  Grid<SegmentIndex> labels(8, 4 * count);
  for (int y = 0; y < labels.height(); ++y)
    for (int x = 0; x < labels.width(); ++x) labels(x, y) = static_cast<SegmentIndex>(y / 4);
  return DescribeSegments(labels, ConstantPicture(8, 4 * count));
}

std::vector<std::uint8_t> StillOf(const SegmentMap& segments, const YcbcrImage& before, const YcbcrImage& now) {
  return StillSegments(segments, before, now, kThreshold);
}

TEST(StillSegments, ChangeOfAPixelReleasesItsSegmentAndThoseBeside) {
  const SegmentMap segments = Strips(5);
  const YcbcrImage before = ConstantPicture(8, 20);
  for (const int x : {0, 4, 7}) {  // at a border too
    YcbcrImage now = before;
    now(x, 9).cb = static_cast<std::uint8_t>(now(x, 9).cb + 9 * kThreshold);
    EXPECT_EQ(StillOf(segments, before, now), (std::vector<std::uint8_t>{1, 0, 0, 0, 1})) << x;
  }
}

TEST(StillSegments, ChangesBelowTheThresholdAreNoise) {
  const SegmentMap segments = Strips(3);
  const YcbcrImage before = ConstantPicture(8, 12);
  YcbcrImage now = before;
  for (Ycbcr& pixel : now.values()) pixel.y = static_cast<std::uint8_t>(pixel.y + kThreshold - 1);
  now(3, 5).y = static_cast<std::uint8_t>(now(3, 5).y + 8);  // the mean of nine stays below 3
  EXPECT_EQ(StillOf(segments, before, now), (std::vector<std::uint8_t>{1, 1, 1}));
  for (Ycbcr& pixel : now.values()) pixel.y = static_cast<std::uint8_t>(pixel.y + 1);
  EXPECT_EQ(StillOf(segments, before, now), (std::vector<std::uint8_t>{0, 0, 0}));
}

TEST(StillSegments, AChangeOfTheMaskCounts) {
  const SegmentMap segments = Strips(3);
  const YcbcrImage before = ConstantPicture(8, 12);
  YcbcrImage now = before;
  now(0, 0).matte = kForegroundMatte;
  EXPECT_EQ(StillOf(segments, before, now), (std::vector<std::uint8_t>{0, 0, 1}));
}

TEST(StillSegments, NothingStandsStillByAThresholdOfZero) {
  const SegmentMap segments = Strips(2);
  const YcbcrImage picture = ConstantPicture(8, 8);
  EXPECT_EQ(StillSegments(segments, picture, picture, 0), (std::vector<std::uint8_t>{0, 0}));
}

TEST(RegrowSnic, KeepsStillSegmentsAndUsesEveryLabelConnected) {
  for (const NamedPicture& named : PropertyPictures()) {
    const YcbcrImage& picture = named.picture;
    const SegmentMap before = DescribeSegments(SegmentSnic(picture, named.num_segments, kCompactness).value(), picture);
    std::vector<std::uint8_t> still(before.centers.size());
    for (std::size_t s = 0; s < still.size(); ++s) still[s] = s % 3 == 0 ? 1 : 0;
    const YcbcrImage other = NoisePicture(picture.width(), picture.height(), 7);
    const Grid<SegmentIndex> labels = RegrowSnic(other, before, still, kCompactness).value();
    EXPECT_TRUE(ValidateLabels(labels).ok()) << named;
    EXPECT_EQ(DescribeSegments(labels, other).centers.size(), before.centers.size()) << named;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const SegmentIndex was = before.labels.values()[i];
      const SegmentIndex is = labels.values()[i];
      ASSERT_TRUE(still[was] != 0 ? is == was : still[is] == 0) << named << ": pixel " << i;
    }
  }
}

TEST(RegrowSnic, RefusesAPictureOfAnotherSize) {
  const SegmentMap before = Strips(2);
  EXPECT_EQ(RegrowSnic(ConstantPicture(8, 9), before, {1, 1}, kCompactness).status().code(),
            ErrorCode::kInvalidArgument);
}

TEST(AnalyseNextView, KeepsTheSegmentsOfAPictureThatStandsStill) {
  const ViewAnalysis before = AnalyseView(ScenePicture(40, 30, 1), 60, kCompactness).value();
  YcbcrImage now = before.picture;
  EXPECT_EQ(AnalyseNextView(now, before, kThreshold, kCompactness).value(), before);
  for (int y = 10; y < 16; ++y)
    for (int x = 10; x < 16; ++x) now(x, y) = {255, 0, 0};
  const ViewAnalysis next = AnalyseNextView(now, before, kThreshold, kCompactness).value();
  EXPECT_NE(next.segments.labels, before.segments.labels);
  EXPECT_EQ(next.segments.labels(39, 29), before.segments.labels(39, 29));
  EXPECT_EQ(next.segments, DescribeSegments(next.segments.labels, now));
  EXPECT_EQ(AnalyseNextView(ScenePicture(41, 30, 1), before, kThreshold, kCompactness).status().code(),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
