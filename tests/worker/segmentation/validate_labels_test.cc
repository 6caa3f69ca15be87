#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "worker/segmentation/describe.h"

namespace depthfarm {
namespace {

Status Validate(int width, std::vector<SegmentIndex> values) {
  Grid<SegmentIndex> labels(width, static_cast<int>(values.size()) / width);
  labels.values() = std::move(values);
  return ValidateLabels(labels);
}

TEST(ValidateLabels, AcceptsConnectedSegmentsOfEveryLabel) {
  EXPECT_TRUE(Validate(3, {0, 0, 1, 2, 2, 1}).ok());
  EXPECT_TRUE(Validate(1, {0}).ok());
}

TEST(ValidateLabels, AcceptsADiagonalLink) {
  EXPECT_TRUE(Validate(2, {0, 1, 1, 0}).ok());
  EXPECT_TRUE(Validate(4, {1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}).ok());
}

TEST(ValidateLabels, RefusesASegmentInTwoParts) {
  const Status status = Validate(3, {0, 1, 0, 0, 1, 0});
  EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
  EXPECT_EQ(status.message(), "segment 0 has a second part at (2, 0), expected one 8-connected segment a label");
}

TEST(ValidateLabels, DoesNotLinkTheEndOfARowToTheNext) {
  EXPECT_EQ(Validate(3, {1, 1, 0, 0, 1, 1}).code(), ErrorCode::kCorrupt);
}

TEST(ValidateLabels, RefusesAnUnusedLabel) {
  const Status status = Validate(2, {0, 0, 2, 2});
  EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
  EXPECT_EQ(status.message(), "label 1 has no pixel, expected labels 0 to 2 to be used");
}

TEST(ValidateLabels, RefusesALabelThatNoPictureOfThisSizeCanHave) {
  EXPECT_EQ(Validate(2, {0, 4294967295U}).code(), ErrorCode::kCorrupt);
  EXPECT_EQ(Validate(2, {0, 2}).code(), ErrorCode::kCorrupt);
}

// Every map of 3 x 3 pixels with labels 0 to 2, by a search of its own.
TEST(ValidateLabels, IsRightForAllSmallMaps) {
  constexpr int kSide = 3;
  constexpr int kPixels = kSide * kSide;
  const auto reached_from = [](const std::vector<SegmentIndex>& values, int start) {
    std::vector<bool> reached(kPixels, false);
    std::vector<int> open = {start};
    reached[static_cast<std::size_t>(start)] = true;
    while (!open.empty()) {
      const int pixel = open.back();
      open.pop_back();
      for (int other = 0; other < kPixels; ++other) {
        const bool near = std::abs(other % kSide - pixel % kSide) <= 1 && std::abs(other / kSide - pixel / kSide) <= 1;
        if (!near || reached[static_cast<std::size_t>(other)] ||
            values[static_cast<std::size_t>(other)] != values[static_cast<std::size_t>(start)]) {
          continue;
        }
        reached[static_cast<std::size_t>(other)] = true;
        open.push_back(other);
      }
    }
    return std::ranges::count(reached, true);
  };
  for (int map = 0; map < 19'683; ++map) {  // 3^9
    std::vector<SegmentIndex> values;
    for (int rest = map, i = 0; i < kPixels; ++i, rest /= 3) values.push_back(static_cast<SegmentIndex>(rest % 3));
    const SegmentIndex last = *std::ranges::max_element(values);
    bool right = true;
    for (SegmentIndex label = 0; label <= last; ++label) {
      const auto first = std::ranges::find(values, label);
      right = right && first != values.end() &&
              reached_from(values, static_cast<int>(first - values.begin())) == std::ranges::count(values, label);
    }
    ASSERT_EQ(Validate(kSide, values).ok(), right) << map;
  }
}

TEST(ValidateLabels, RefusesAnEmptyMap) { EXPECT_EQ(ValidateLabels(Grid<SegmentIndex>()).code(), ErrorCode::kCorrupt); }

}  // namespace
}  // namespace depthfarm
