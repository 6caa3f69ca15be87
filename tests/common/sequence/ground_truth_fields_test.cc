#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/sequence/read_sequence.h"
#include "tests/common/sequence/sequence_text.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing_support::TemporaryFolder;

// The small sequence with this ground truth.
Result<Sequence> ReadWith(const TemporaryFolder& folder, const std::string& truth) {
  const std::string text = Replaced(kSequenceText, "\"x-own\"", "\"groundTruth\": " + truth + ", \"x-own\"");
  return ReadSequence(folder.Write("s.json", Replaced(text, "\"x-own\"", "\"x-disparityOffset\": 8, \"x-own\"")));
}

std::string Worded(const std::string& encoding, const std::string& depth) {
  return R"({"view": "a", "file": "gt", "encoding": ")" + encoding + R"(", "depth": ")" + depth + R"("})";
}

TEST(GroundTruthFields, ReadsDisparityOfAnEightBitPicture) {
  const TemporaryFolder folder;
  const auto sequence = ReadWith(folder, R"({"view": "a", "file": "gt.png", "depth": "z = 450.0/disparity",
      "encoding": "8-bit, disparity = value/4, 0 = unknown", "masks": "nonocc.png, all.png: 255 = counted"})");
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ASSERT_THAT(sequence->ground_truth, SizeIs(1));
  const GroundTruthView& view = sequence->ground_truth[0];
  EXPECT_EQ(view.view, "a");
  EXPECT_EQ(view.encoding, GroundTruthView::Encoding::kDisparityPng);
  EXPECT_EQ(view.scale, 450);
  EXPECT_EQ(view.divisor, 4);
  EXPECT_EQ(view.offset, 0);
  EXPECT_THAT(view.depth, ElementsAre(folder.File("gt.png")));
  EXPECT_EQ(view.nonoccluded_mask, folder.File("nonocc.png"));
  EXPECT_THAT(sequence->warnings, IsEmpty());
}

TEST(GroundTruthFields, TakesTheOffsetOfDisparityFromTheSequence) {
  const TemporaryFolder folder;
  for (const auto& [depth, offset] : {std::pair<std::string, double>{"z = 1000/(disparity + disparityOffset)", 8},
                                      {"z = 1000/(disparity + 2.5)", 2.5}}) {
    const auto sequence =
        ReadWith(folder, Worded("PFM float32, pixels per grid step, bottom row first as PFM prescribes", depth));
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    ASSERT_THAT(sequence->ground_truth, SizeIs(1));
    EXPECT_EQ(sequence->ground_truth[0].encoding, GroundTruthView::Encoding::kDisparityPfm);
    EXPECT_EQ(sequence->ground_truth[0].scale, 1000);
    EXPECT_EQ(sequence->ground_truth[0].offset, offset);
  }
}

TEST(GroundTruthFields, WordsThatAreNotUnderstoodAreAWarningNotAnError) {
  const std::string eight = "8-bit, disparity = value/4, 0 = unknown";
  const TemporaryFolder folder;
  for (const auto& [encoding, depth] :
       {std::pair<std::string, std::string>{"8-bit, disparity = value/0, 0 = unknown", "z = 1/disparity"},
        {"12-bit, disparity = value, 0 = unknown", "z = 1/disparity"},
        {"8-bit, disparity = value/4", "z = 1/disparity"},
        {"PFM float32, pixels per grid step, top row first", "z = 1/disparity"},
        {eight, "z = -450/disparity"},
        {eight, "z = 450*disparity"},
        {eight, "z = 450/disparity + 1"},
        {eight, "z = 450/(disparity + other)"},
        {eight, "z = inf/disparity"},
        {"z-pfm", "z = 1/disparity"},
        {"", ""}}) {
    const auto sequence = ReadWith(folder, Worded(encoding, depth));
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    EXPECT_THAT(sequence->ground_truth, IsEmpty()) << encoding << " " << depth;
    ASSERT_THAT(sequence->warnings, SizeIs(1)) << encoding << " " << depth;
    EXPECT_THAT(sequence->warnings[0], HasSubstr("not affected"));
  }
}

TEST(GroundTruthFields, ReadsDepthAndZonesOfRenderedViews) {
  const TemporaryFolder folder;
  const auto sequence = ReadWith(folder, R"({"encoding": "z-pfm", "zones": {"wall": 1, "person": 2}, "views": [
      {"view": "a", "depth": ["t/0.pfm", "t/1.pfm"], "zones": ["t/0.png", "t/1.png"]},
      {"view": "b", "depth": ["u/0.pfm", "u/1.pfm"]}]})");
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ASSERT_THAT(sequence->ground_truth, SizeIs(2));
  EXPECT_EQ(sequence->ground_truth[0].encoding, GroundTruthView::Encoding::kDepthPfm);
  EXPECT_THAT(sequence->ground_truth[0].depth, ElementsAre(folder.File("t/0.pfm"), folder.File("t/1.pfm")));
  EXPECT_THAT(sequence->ground_truth[0].zones, ElementsAre(folder.File("t/0.png"), folder.File("t/1.png")));
  EXPECT_EQ(sequence->ground_truth[1].view, "b");
  EXPECT_THAT(sequence->ground_truth[1].zones, IsEmpty());
}

TEST(GroundTruthFields, RefusesWrongShapes) {
  const TemporaryFolder folder;
  const std::string two = R"("depth": ["0", "1"])";
  for (const auto& [truth, words] : {
           std::pair<std::string, std::string>{R"({"view": "c", "file": "f", "encoding": "e"})", "'view' is 'c'"},
           {R"({"view": "a", "encoding": "e"})", "'file' is missing"},
           {R"({"view": "a", "file": "../f", "encoding": "e"})", "stays in the folder"},
           {R"({"view": "a", "file": "f", "encoding": 8})", "'encoding' is 8"},
           {R"({"view": "a", "file": "f", "encoding": "e", "unit": "m"})", "unknown key \"unit\""},
           {R"({"encoding": "z-pfm", "views": {}})", "'views' is {}"},
           {R"({"encoding": "z-pfm", "views": [{"view": "c", )" + two + "}]}", "'view' is 'c'"},
           {R"({"encoding": "z-pfm", "views": [{"view": "a"}]})", "'depth' is missing"},
           {R"({"encoding": "z-pfm", "views": [{"view": "a", "depth": ["0"]}]})", "expected one per frame, 2"},
           {R"({"encoding": "z-pfm", "views": [{"view": "a", )" + two + R"(, "zones": ["0"]}]})", "one per frame, 2"},
           {R"({"encoding": "z-pfm", "views": [{"view": "a", )" + two + R"(}, {"view": "a", )" + two + "}]}", "twice"},
           {R"({"encoding": "z-pfm", "zones": {"wall": 256}, "views": []})", "'wall' is 256"},
       }) {
    const auto sequence = ReadWith(folder, truth);
    EXPECT_EQ(sequence.status().code(), ErrorCode::kInvalidArgument) << truth;
    EXPECT_THAT(sequence.status().message(), HasSubstr(words));
    EXPECT_THAT(sequence.status().message(), HasSubstr("groundTruth"));
  }
}

}  // namespace
}  // namespace depthfarm
