#include "common/compression/zstd_frame.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace depthfarm {
namespace {

std::string Frame(const std::string& content) {
  std::string bytes;
  AppendZstdFrame(content, bytes);
  return bytes;
}

TEST(ZstdFrame, GivesBackItsContent) {
  for (const std::string& content : {std::string(), std::string("abc"), std::string(1'000'000, 'x')}) {
    const auto read = ReadZstdFrame(Frame(content), content.size(), content.size());
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(*read, content);
  }
}

TEST(ZstdFrame, GivesBackContentThatIsCut) {
  std::mt19937 random(5);
  std::string noise(300'000, '\0');
  for (char& byte : noise) byte = static_cast<char>(random());
  for (const std::string& content : {std::string(), std::string("abc"), std::string(300'000, 'x'), noise}) {
    std::vector<std::size_t> everywhere;
    for (std::size_t cut = 0; cut <= content.size(); cut += 1 + content.size() / 1000) everywhere.push_back(cut);
    using Cuts = std::vector<std::size_t>;
    for (const Cuts& cuts : {Cuts{0}, Cuts{content.size()}, Cuts{0, 0, content.size(), content.size()}, everywhere}) {
      std::string frame;
      AppendZstdFrame(content, frame, cuts);
      const auto read = ReadZstdFrame(frame, content.size(), content.size());
      ASSERT_TRUE(read.ok()) << read.status().message();
      EXPECT_EQ(*read, content);
      std::string again;
      AppendZstdFrame(content, again, cuts);
      EXPECT_EQ(again, frame);
    }
  }
}

// Halves that use other bytes: one code for both would take a bit a byte more.
TEST(ZstdFrame, CodesPartsApart) {
  std::mt19937 random(6);
  std::string content;
  for (int i = 0; i < 60'000; ++i)
    content.push_back(static_cast<char>(i < 30'000 ? random() % 16 : 16 + random() % 16));
  std::string cut;
  AppendZstdFrame(content, cut, std::vector<std::size_t>{30'000});
  EXPECT_LT(cut.size(), 60'000U / 2 + 200);
  EXPECT_GT(Frame(content).size(), 60'000U * 5 / 8 - 200);
}

TEST(ZstdFrame, GivesTheStartWithoutTheRest) {
  const auto start = ReadZstdFrameStart(Frame("header, then more"), 6);
  ASSERT_TRUE(start.ok());
  EXPECT_EQ(*start, "header");
  EXPECT_EQ(ReadZstdFrameStart(Frame("head"), 6).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadZstdFrameStart("", 6).status().code(), ErrorCode::kCorrupt);
}

TEST(ZstdFrame, RefusesSizesOutOfBounds) {
  const std::string frame = Frame(std::string(100, 'x'));
  EXPECT_EQ(ReadZstdFrame(frame, 101, 200).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadZstdFrame(frame, 0, 99).status().code(), ErrorCode::kCorrupt);
}

TEST(ZstdFrame, RefusesAFrameWithoutChecksum) {
  const std::string content = "unchecked";
  std::string frame(ZSTD_compressBound(content.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), content.data(), content.size(), 3));
  const Status status = ReadZstdFrame(frame, 0, 100).status();
  EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
  EXPECT_EQ(status.message(), "compressed content carries no checksum");
}

TEST(ZstdFrame, RefusesWhatFollowsIt) {
  EXPECT_EQ(ReadZstdFrame(Frame("abc") + "x", 0, 100).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(ReadZstdFrame(Frame("abc") + Frame("def"), 0, 100).status().code(), ErrorCode::kCorrupt);
}

}  // namespace
}  // namespace depthfarm
