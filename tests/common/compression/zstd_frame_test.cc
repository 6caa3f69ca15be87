#include "common/compression/zstd_frame.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <string>

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
