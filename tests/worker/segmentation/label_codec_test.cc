#include "worker/segmentation/label_codec.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace depthfarm {
namespace {

Grid<SegmentIndex> RandomLabels(int width, int height, SegmentIndex num_segments, std::uint32_t seed) {
  std::mt19937 random(seed);
  Grid<SegmentIndex> labels(width, height);
  for (SegmentIndex& label : labels.values()) label = static_cast<SegmentIndex>(random() % num_segments);
  return labels;
}

std::string Encoded(const Grid<SegmentIndex>& labels) {
  std::string bytes;
  AppendLabels(labels, bytes);
  return bytes;
}

TEST(LabelCodec, ReadsBackAnyLabels) {
  for (const SegmentIndex num_segments : {1U, 2U, 5U, 100'000U, 4294967295U}) {
    const Grid<SegmentIndex> labels = RandomLabels(37, 21, num_segments, num_segments);
    const auto read = ReadLabels(Encoded(labels), 37, 21, num_segments);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(*read, labels);
  }
}

TEST(LabelCodec, TakesOneExplicitLabelForEachSegmentOfABlockMap) {
  Grid<SegmentIndex> labels(12, 12);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) labels(x, y) = static_cast<SegmentIndex>(y / 4 * 3 + x / 4);
  }
  EXPECT_EQ(Encoded(labels).size(), 144U + 8U);  // label 0 is expected at the first pixel
}

TEST(LabelCodec, RefusesLabelsOutsideTheirNumber) {
  const std::string bytes = Encoded(RandomLabels(9, 9, 50, 1));
  EXPECT_EQ(ReadLabels(bytes, 9, 9, 20).status().code(), ErrorCode::kCorrupt);
}

TEST(LabelCodec, RefusesTruncatedAndExtendedBytes) {
  const Grid<SegmentIndex> labels = RandomLabels(9, 9, 50, 1);
  const std::string bytes = Encoded(labels);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(ReadLabels(bytes.substr(0, size), 9, 9, 50).status().code(), ErrorCode::kCorrupt) << size;
  }
  EXPECT_EQ(ReadLabels(bytes + '\0', 9, 9, 50).status().code(), ErrorCode::kCorrupt);
}

TEST(LabelCodec, RefusesUnknownRulesAndEndlessNumbers) {
  EXPECT_EQ(ReadLabels(std::string("\x04"), 1, 1, 1).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadLabels(std::string("\xff"), 1, 1, 1).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadLabels(std::string("\x03\x80\x80\x80\x80\x80\x01"), 1, 1, 1).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadLabels(std::string("\x03\x01"), 1, 1, 1).status().code(), ErrorCode::kCorrupt);  // label -1
}

}  // namespace
}  // namespace depthfarm
