#include "worker/segmentation/analysis_codec.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "common/compression/zstd_frame.h"
#include "tests/worker/segmentation/test_pictures.h"
#include "worker/segmentation/describe.h"
#include "worker/segmentation/label_codec.h"

namespace depthfarm {
namespace {

ViewAnalysis SmallAnalysis() { return AnalyseView(ScenePicture(24, 18, 1), 20, 5).value(); }

std::string LittleEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xFFU));
  return bytes;
}

// Bytes of a well-formed frame with a content of our choice.
std::string WithContent(const std::string& content) {
  std::string bytes = "DFVA" + LittleEndian(3);
  AppendZstdFrame(content, bytes);
  return bytes;
}

std::string Content(std::uint32_t width, std::uint32_t height, std::uint32_t num_segments,
                    const Grid<SegmentIndex>& labels) {
  std::string content = LittleEndian(width) + LittleEndian(height) + LittleEndian(num_segments);
  content.append(12, '\0');  // no matte, no prior
  content.append(3 * labels.size(), '\0');
  std::vector<std::size_t> cuts;
  AppendLabels(labels, content, cuts);
  return content;
}

class AnalysisCodecProperty : public testing::TestWithParam<NamedPicture> {};
INSTANTIATE_TEST_SUITE_P(Pictures, AnalysisCodecProperty, testing::ValuesIn(PropertyPictures()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST_P(AnalysisCodecProperty, GivesBackTheAnalysis) {
  const ViewAnalysis analysis = AnalyseView(GetParam().picture, GetParam().num_segments, 5).value();
  const auto decoded = DecodeAnalysis(EncodeAnalysis(analysis));
  ASSERT_TRUE(decoded.ok()) << decoded.status().message();
  EXPECT_EQ(*decoded, analysis);
}

TEST_P(AnalysisCodecProperty, GivesTheSameBytesAgain) {
  const ViewAnalysis analysis = AnalyseView(GetParam().picture, GetParam().num_segments, 5).value();
  const std::string bytes = EncodeAnalysis(analysis);
  EXPECT_EQ(EncodeAnalysis(analysis), bytes);
  EXPECT_EQ(EncodeAnalysis(DecodeAnalysis(bytes).value()), bytes);
}

// With a foreground mask and a prior of which little is known.
ViewAnalysis GuidedAnalysis(bool with_confidence) {
  ViewAnalysis analysis = SmallAnalysis();
  Grid<float> values(24, 18);
  Grid<float> confidence(with_confidence ? 24 : 0, with_confidence ? 18 : 0);
  for (int y = 0; y < 18; ++y) {
    for (int x = 0; x < 24; ++x) {
      if (x < 12) analysis.picture(x, y).matte = kForegroundMatte;
      if (x > 4) values(x, y) = 0.01F * static_cast<float>(x) + 0.002F * static_cast<float>(y);
      if (with_confidence) confidence(x, y) = static_cast<float>(y) / 17;
    }
  }
  analysis.segments = DescribeSegments(analysis.segments.labels, analysis.picture);
  analysis.prior = MakePrior(values, confidence);
  analysis.prior.segments = DescribePrior(analysis.segments, analysis.prior);
  return analysis;
}

TEST(AnalysisCodec, GivesBackMaskAndPrior) {
  for (const bool with_confidence : {false, true}) {
    const ViewAnalysis analysis = GuidedAnalysis(with_confidence);
    const auto decoded = DecodeAnalysis(EncodeAnalysis(analysis));
    ASSERT_TRUE(decoded.ok()) << decoded.status().message();
    EXPECT_EQ(*decoded, analysis);
  }
}

TEST(AnalysisCodec, RefusesHeadersThatNoAnalysisHas) {
  const Grid<SegmentIndex> labels(2, 2, 0);
  const auto with = [&](std::size_t at, std::uint32_t value) {
    return DecodeAnalysis(WithContent(Content(2, 2, 1, labels).replace(at, 4, LittleEndian(value)))).status().code();
  };
  EXPECT_EQ(with(12, 8), ErrorCode::kCorrupt);           // unknown flag
  EXPECT_EQ(with(12, 4), ErrorCode::kCorrupt);           // confidence of no prior
  EXPECT_EQ(with(12, 2), ErrorCode::kCorrupt);           // a prior that is not there
  EXPECT_EQ(with(16, 0x7FC00000), ErrorCode::kCorrupt);  // NaN
  EXPECT_EQ(with(16, 0xBF800000), ErrorCode::kCorrupt);  // lowest -1
  EXPECT_EQ(with(16, 0x7149F2CA), ErrorCode::kCorrupt);  // 1e30
  EXPECT_EQ(with(20, 0xBF800000), ErrorCode::kCorrupt);  // step -1
  EXPECT_EQ(with(20, 0x7149F2CA), ErrorCode::kCorrupt);  // 1e30
}

TEST(AnalysisCodec, TakesLessThanHalfOfThePlainBytesOfAScene) {
  const ViewAnalysis analysis = AnalyseView(ScenePicture(320, 240, 2), 320 * 240 / 20, 5).value();
  const std::size_t plain = analysis.picture.size() * (3 + sizeof(SegmentIndex));
  EXPECT_LT(EncodeAnalysis(analysis).size(), plain / 2);
}

TEST(AnalysisCodec, RefusesEveryTruncation) {
  const std::string bytes = EncodeAnalysis(SmallAnalysis());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(DecodeAnalysis(std::string_view(bytes).substr(0, size)).status().code(), ErrorCode::kCorrupt) << size;
  }
  EXPECT_EQ(DecodeAnalysis(bytes + '\0').status().code(), ErrorCode::kCorrupt);
}

// A few bits of a zstd frame are padding or have equivalents: a change there may pass, as nothing is lost.
TEST(AnalysisCodec, NeverGivesAnotherAnalysisForAFlippedBit) {
  const ViewAnalysis analysis = SmallAnalysis();
  const std::string bytes = EncodeAnalysis(analysis);
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    const auto decoded = DecodeAnalysis(damaged);
    if (decoded.ok()) {
      ASSERT_EQ(*decoded, analysis) << "bit " << bit;
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(8 * bytes.size() * 99 / 100));
}

TEST(AnalysisCodec, SurvivesRandomDamage) {
  const ViewAnalysis analysis = SmallAnalysis();
  const std::string bytes = EncodeAnalysis(analysis);
  std::mt19937 random(3);
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = bytes;
    const std::size_t changes = 1 + random() % 20;
    for (std::size_t change = 0; change < changes; ++change) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    const auto decoded = DecodeAnalysis(damaged);
    if (!decoded.ok()) continue;
    ASSERT_EQ(*decoded, analysis) << "round " << i;
  }
}

// Damage that the checksum can't see: content made to harm.
TEST(AnalysisCodec, SurvivesDamagedContentInAValidFrame) {
  const ViewAnalysis analysis = SmallAnalysis();
  std::string content =
      Content(24, 18, static_cast<std::uint32_t>(analysis.segments.num_segments()), analysis.segments.labels);
  ASSERT_TRUE(DecodeAnalysis(WithContent(content)).ok());
  std::mt19937 random(4);
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = content;
    const std::size_t changes = 1 + random() % 4;
    for (std::size_t change = 0; change < changes; ++change) {
      damaged[random() % damaged.size()] = static_cast<char>(random() % 3 == 0 ? random() : random() % 4);
    }
    const auto decoded = DecodeAnalysis(WithContent(damaged));
    if (!decoded.ok()) continue;
    ASSERT_EQ(decoded->segments.labels.size(), decoded->picture.size());
    ASSERT_EQ(DecodeAnalysis(EncodeAnalysis(*decoded)).value(), *decoded);
  }
}

TEST(AnalysisCodec, RefusesSizesBeforeTakingMemoryForThem) {
  const Grid<SegmentIndex> labels(2, 2, 0);
  EXPECT_TRUE(DecodeAnalysis(WithContent(Content(2, 2, 1, labels))).ok());
  for (const std::uint32_t side : {0U, 3U, 16384U, 16385U, 0x80000000U, 0xFFFFFFFFU}) {
    EXPECT_EQ(DecodeAnalysis(WithContent(Content(side, 2, 1, labels))).status().code(), ErrorCode::kCorrupt) << side;
    EXPECT_EQ(DecodeAnalysis(WithContent(Content(2, side, 1, labels))).status().code(), ErrorCode::kCorrupt) << side;
    EXPECT_EQ(DecodeAnalysis(WithContent(Content(side, side, 1, labels))).status().code(), ErrorCode::kCorrupt);
  }
}

TEST(AnalysisCodec, RefusesAWrongNumberOfSegments) {
  const Grid<SegmentIndex> labels(2, 2, 0);
  for (const std::uint32_t num_segments : {0U, 2U, 5U, 0xFFFFFFFFU}) {
    EXPECT_EQ(DecodeAnalysis(WithContent(Content(2, 2, num_segments, labels))).status().code(), ErrorCode::kCorrupt);
  }
}

TEST(AnalysisCodec, RefusesSegmentsInTwoParts) {
  Grid<SegmentIndex> labels(3, 1, 0);
  labels(1, 0) = 1;
  const Status status = DecodeAnalysis(WithContent(Content(3, 1, 2, labels))).status();
  EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
  EXPECT_EQ(status.message(),
            "view analysis: segment 0 has a second part at (2, 0), expected one 8-connected segment a label");
}

TEST(AnalysisCodec, TellsAnotherVersionFromDamage) {
  std::string bytes = EncodeAnalysis(SmallAnalysis());
  bytes[4] = 1;
  const Status status = DecodeAnalysis(bytes).status();
  EXPECT_EQ(status.code(), ErrorCode::kIncompatible);
  EXPECT_EQ(status.message(), "view analysis: version is 1, expected 3");
}

}  // namespace
}  // namespace depthfarm
