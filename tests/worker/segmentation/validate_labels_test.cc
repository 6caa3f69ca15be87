#include <gtest/gtest.h>

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

TEST(ValidateLabels, RefusesAnEmptyMap) { EXPECT_EQ(ValidateLabels(Grid<SegmentIndex>()).code(), ErrorCode::kCorrupt); }

}  // namespace
}  // namespace depthfarm
