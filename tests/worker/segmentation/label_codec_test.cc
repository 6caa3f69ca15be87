#include "worker/segmentation/label_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/base/little_endian.h"
#include "common/compression/zstd_frame.h"
#include "tests/worker/segmentation/test_pictures.h"
#include "worker/segmentation/label_contexts.h"
#include "worker/segmentation/snic.h"

namespace depthfarm {
namespace {

Grid<SegmentIndex> RandomLabels(int width, int height, SegmentIndex num_segments, std::uint32_t seed) {
  std::mt19937 random(seed);
  Grid<SegmentIndex> labels(width, height);
  for (SegmentIndex& label : labels.values()) label = static_cast<SegmentIndex>(random() % num_segments);
  return labels;
}

// As segments, of which pixels mostly are like a neighbour.
Grid<SegmentIndex> RandomPatches(int width, int height, SegmentIndex num_segments, std::uint32_t seed) {
  std::mt19937 random(seed);
  Grid<SegmentIndex> labels(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      SegmentIndex& label = labels(x, y);
      const std::uint32_t choice = random() % 8;
      if (choice < 3 && x > 0) {
        label = labels(x - 1, y);
      } else if (choice < 6 && y > 0) {
        label = labels(std::min(x + static_cast<int>(random() % 2), width - 1), y - 1);
      } else {
        label = static_cast<SegmentIndex>(random() % num_segments);
      }
    }
  }
  return labels;
}

std::string Encoded(const Grid<SegmentIndex>& labels) {
  std::string bytes;
  std::vector<std::size_t> cuts;
  AppendLabels(labels, bytes, cuts);
  return bytes;
}

double CompressedBitsPerPixel(const Grid<SegmentIndex>& labels) {
  std::string bytes;
  std::vector<std::size_t> cuts;
  AppendLabels(labels, bytes, cuts);
  std::string frame;
  AppendZstdFrame(bytes, frame, cuts);
  return 8.0 * static_cast<double>(frame.size()) / static_cast<double>(labels.size());
}

// That the map is read back from its bytes, and that the bounds of these hold.
void ExpectReadBack(const Grid<SegmentIndex>& labels, SegmentIndex num_segments) {
  const std::string bytes = Encoded(labels);
  EXPECT_GE(bytes.size(), LeastLabelBytes(labels.size()));
  EXPECT_LE(bytes.size(), MostLabelBytes(labels.size()));
  EXPECT_EQ(Encoded(labels), bytes);
  const auto read = ReadLabels(bytes, labels.width(), labels.height(), num_segments);
  ASSERT_TRUE(read.ok()) << labels.width() << "x" << labels.height() << ": " << read.status().message();
  EXPECT_EQ(*read, labels);
}

TEST(LabelCodec, ReadsBackAnyLabels) {
  for (const SegmentIndex num_segments : {1U, 2U, 5U, 300U, 100'000U, 4294967295U}) {
    ExpectReadBack(RandomLabels(37, 21, num_segments, num_segments), num_segments);
    ExpectReadBack(RandomPatches(137, 61, num_segments, num_segments), num_segments);
  }
}

TEST(LabelCodec, ReadsBackMapsOfAnyShape) {
  for (int width = 1; width <= 9; ++width) {
    for (int height = 1; height <= 9; ++height) {
      for (const SegmentIndex num_segments : {1U, 2U, 4U, 1000U}) {
        ExpectReadBack(RandomLabels(width, height, num_segments, num_segments), num_segments);
        ExpectReadBack(RandomPatches(width, height, num_segments, num_segments), num_segments);
      }
    }
  }
}

TEST(LabelCodec, ReadsBackLabelsFromOneEndToTheOther) {
  Grid<SegmentIndex> labels(64, 64);
  for (std::size_t i = 0; i < labels.size(); ++i)
    labels.values()[i] = static_cast<SegmentIndex>(i % 3 == 0 ? i : 4294967294U - i);
  ExpectReadBack(labels, 4294967295U);
}

class LabelCodecProperty : public testing::TestWithParam<NamedPicture> {};
INSTANTIATE_TEST_SUITE_P(Pictures, LabelCodecProperty, testing::ValuesIn(PropertyPictures()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST_P(LabelCodecProperty, ReadsBackSuperpixels) {
  const Grid<SegmentIndex> labels = SegmentSnic(GetParam().picture, GetParam().num_segments, 5).value();
  ExpectReadBack(labels, static_cast<SegmentIndex>(labels.size()));
}

// Every partition of four labels that a context tells from others, and every rule in it.
TEST(LabelCodec, ReadsBackEveryRuleOfEveryContext) {
  std::set<unsigned> contexts;
  for (SegmentIndex code = 0; code < 5U * 5 * 5 * 5 * 5; ++code) {
    Grid<SegmentIndex> labels(3, 2);
    SegmentIndex rest = code;
    for (const std::size_t at : {0U, 1U, 2U, 3U, 4U}) {
      labels.values()[at] = rest % 5;
      rest /= 5;
    }
    contexts.insert(LabelsAround{
        .left = labels(0, 1), .above_left = labels(0, 0), .above = labels(1, 0), .above_right = labels(2, 0)}
                        .Context());
    ExpectReadBack(labels, 5);
  }
  EXPECT_EQ(std::vector<unsigned>(contexts.begin(), contexts.end()),
            std::vector<unsigned>(kContexts.begin(), kContexts.end()));
}

TEST(LabelCodec, TakesOneExplicitLabelForEachSegmentOfABlockMap) {
  Grid<SegmentIndex> labels(12, 12);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) labels(x, y) = static_cast<SegmentIndex>(y / 4 * 3 + x / 4);
  }
  // Label 0 is expected at the first pixel; the others are one more each than the largest before.
  const std::string bytes = Encoded(labels);
  EXPECT_EQ(ReadU32(bytes, 4 * kContexts.size()), 8U);
  EXPECT_EQ(ReadU32(bytes, 4 * kContexts.size() + 4), 0U);
  EXPECT_EQ(bytes.substr(bytes.size() - 8), std::string(8, '\0'));
}

// SNIC with as many segments as pixels / 20, as by default.
TEST(LabelCodec, TakesLittleForTheSegmentsOfAScene) {
  const Grid<SegmentIndex> labels = SegmentSnic(ScenePicture(320, 240, 2), 320 * 240 / 20, 5).value();
  EXPECT_LT(CompressedBitsPerPixel(labels), 1.5);
}

// The map of a refined P frame: planes that pixels keep are numbered as they are met, after those of segments.
TEST(LabelCodec, TakesLittleForNumbersInTheOrderTheyAreMet) {
  const Grid<SegmentIndex> segments = SegmentSnic(ScenePicture(320, 240, 2), 320 * 240 / 20, 5).value();
  std::vector<SegmentIndex> number(segments.size(), 0);
  SegmentIndex next = 1'000'000;
  Grid<SegmentIndex> labels = segments;
  for (SegmentIndex& label : labels.values()) {
    if (number[label] == 0) number[label] = next++;
    label = number[label];
  }
  EXPECT_LT(CompressedBitsPerPixel(labels), 1.8);
}

TEST(LabelCodec, RefusesLabelsOutsideTheirNumber) {
  const std::string bytes = Encoded(RandomLabels(9, 9, 50, 1));
  EXPECT_EQ(ReadLabels(bytes, 9, 9, 20).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadLabels(Encoded(Grid<SegmentIndex>(9, 9)), 9, 9, 0).status().code(), ErrorCode::kCorrupt);
}

TEST(LabelCodec, RefusesAnotherNumberOfPixels) {
  const std::string bytes = Encoded(RandomLabels(9, 9, 50, 1));
  for (const auto& [width, height] : {std::pair{9, 8}, {8, 9}, {9, 10}, {10, 9}, {1, 1}, {16384, 16384}})
    EXPECT_EQ(ReadLabels(bytes, width, height, 50).status().code(), ErrorCode::kCorrupt) << width << "x" << height;
}

TEST(LabelCodec, RefusesTruncatedAndExtendedBytes) {
  for (const Grid<SegmentIndex>& labels :
       {RandomLabels(9, 9, 50, 1), RandomPatches(20, 20, 100'000, 2), Grid<SegmentIndex>(5, 5)}) {
    const std::string bytes = Encoded(labels);
    const auto code = [&labels](const std::string& damaged) {
      return ReadLabels(damaged, labels.width(), labels.height(), 100'000).status().code();
    };
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_EQ(code(bytes.substr(0, size)), ErrorCode::kCorrupt) << size;
    EXPECT_EQ(code(bytes + '\0'), ErrorCode::kCorrupt);
    EXPECT_EQ(code(bytes + std::string(4, '\0')), ErrorCode::kCorrupt);
  }
}

// Whatever the bytes: refused, or a map of the size asked for with labels in range.
TEST(LabelCodec, SurvivesRandomDamage) {
  const Grid<SegmentIndex> labels = RandomPatches(31, 17, 400, 3);
  const std::string bytes = Encoded(labels);
  std::mt19937 random(7);
  int read_back = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string damaged = bytes;
    const std::size_t changes = 1 + random() % 3;
    for (std::size_t change = 0; change < changes; ++change)
      damaged[random() % damaged.size()] = static_cast<char>(random() % 2 == 0 ? random() : random() % 3);
    const auto read = ReadLabels(damaged, 31, 17, 400);
    if (!read.ok()) {
      ASSERT_EQ(read.status().code(), ErrorCode::kCorrupt);
      continue;
    }
    ++read_back;
    ASSERT_EQ(read->size(), labels.size());
    ASSERT_LT(*std::max_element(read->values().begin(), read->values().end()), 400U);
  }
  EXPECT_GT(read_back, 100);  // other labels are labels too
}

// One pixel: its context is that of four equal labels, the last.
std::string OnePixel(std::uint32_t explicit_labels, std::uint32_t table, const std::string& rest) {
  std::string bytes(4 * (kContexts.size() - 1), '\0');
  AppendU32(1, bytes);
  AppendU32(explicit_labels, bytes);
  AppendU32(table, bytes);
  return bytes + rest;
}

TEST(LabelCodec, RefusesRulesAndLabelsThatAreNotThere) {
  const auto read = [](const std::string& bytes) {
    const auto labels = ReadLabels(bytes, 1, 1, 3);
    return labels.ok() ? static_cast<int>(labels->values()[0]) : -1;
  };
  const std::string first(1, '\0');
  const std::string own("\x80");  // digit 1 of eight
  const std::string next(1, '\0');
  const std::string two("\2\0\0\0", 4);
  EXPECT_EQ(read(OnePixel(0, 0, first)), 0);
  EXPECT_EQ(read(OnePixel(1, 0, own + next)), 1);
  EXPECT_EQ(read(OnePixel(1, 1, own + two + "\x01")), 2);
  EXPECT_EQ(read(OnePixel(1, 0, own + "\xFF" + two)), 2);

  EXPECT_EQ(read(OnePixel(0, 0, "\x01")), -1);                                // a rule of an eighth pixel
  EXPECT_EQ(read(OnePixel(0, 0, own)), -1);                                   // no explicit label
  EXPECT_EQ(read(OnePixel(1, 0, own)), -1);                                   // announced, but not there
  EXPECT_EQ(read(OnePixel(1, 0, first + next)), -1);                          // not asked for
  EXPECT_EQ(read(OnePixel(2, 0, own + next + next)), -1);                     // one too many
  EXPECT_EQ(read(OnePixel(1, 0, own + "\x01")), -1);                          // beyond the table
  EXPECT_EQ(read(OnePixel(1, 1, own + two + "\x02")), -1);                    // beyond the table
  EXPECT_EQ(read(OnePixel(1, 0, own + "\xFF\x02")), -1);                      // no whole label
  EXPECT_EQ(read(OnePixel(1, 0, own + next + two)), -1);                      // a label that no code asks for
  EXPECT_EQ(read(OnePixel(1, 0, own + std::string("\xFF\3\0\0\0", 5))), -1);  // label 3
  EXPECT_EQ(read(OnePixel(1, 0xFFFFFFFF, own + next)), -1);                   // a table of 16 GiB
  EXPECT_EQ(read(OnePixel(1, 255, own + std::string(1021, '\0'))), -1);       // larger than codes
  EXPECT_EQ(read(OnePixel(0xFFFFFFFF, 0, own + next)), -1);                   // 4 GiB of explicit labels
}

TEST(LabelCodec, RefusesBytesThatStandForNoRules) {
  // Three rules, five pixels a byte: 243 and more are none.
  Grid<SegmentIndex> labels(2, 2);
  labels(1, 0) = 1;
  std::string bytes = Encoded(labels);
  const auto read = [](const std::string& damaged) { return ReadLabels(damaged, 2, 2, 2).status().code(); };
  ASSERT_TRUE(ReadLabels(bytes, 2, 2, 2).ok());
  int refused = 0;
  for (std::size_t at = 4 * (kContexts.size() + 2); at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = '\xF3';
    refused += read(damaged) == ErrorCode::kCorrupt ? 1 : 0;
  }
  EXPECT_EQ(refused, static_cast<int>(bytes.size() - 4 * (kContexts.size() + 2)));
}

}  // namespace
}  // namespace depthfarm
