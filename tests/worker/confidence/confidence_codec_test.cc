#include "worker/confidence/confidence_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/compression/zstd_frame.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

ConfidenceMap SmallMap() {
  ConfidenceMap map{Grid<std::uint16_t>(7, 3)};
  for (std::size_t i = 0; i < map.codes.size(); ++i)
    map.codes.values()[i] = static_cast<std::uint16_t>(65535 - 3000 * i);
  return map;
}

TEST(ConfidenceCodec, GivesBackTheMap) {
  const auto decoded = DecodeConfidence(EncodeConfidence(SmallMap()));
  ASSERT_TRUE(decoded.ok()) << decoded.status().message();
  EXPECT_EQ(*decoded, SmallMap());
}

TEST(ConfidenceCodec, RefusesEveryTruncation) {
  const std::string bytes = EncodeConfidence(SmallMap());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(DecodeConfidence(std::string_view(bytes).substr(0, size)).status().code(), ErrorCode::kCorrupt) << size;
  EXPECT_EQ(DecodeConfidence(bytes + '\0').status().code(), ErrorCode::kCorrupt);
}

TEST(ConfidenceCodec, RefusesSizesThatItsBytesDoNotHave) {
  const std::string bytes = EncodeConfidence(SmallMap());
  const std::string content = ReadZstdFrame(std::string_view(bytes).substr(8), 8, 1 << 20).value();
  const auto with_width = [&](char low, char high) {
    std::string changed = content;
    changed[0] = low;
    changed[2] = high;
    std::string result = bytes.substr(0, 8);
    AppendZstdFrame(changed, result);
    return DecodeConfidence(result).status();
  };
  EXPECT_EQ(with_width(8, 0).code(), ErrorCode::kCorrupt);
  EXPECT_THAT(with_width(0, 0).message(), HasSubstr("expected sides of 1 to"));
  EXPECT_THAT(with_width(0, 0x7f).message(), HasSubstr("confidence map: "));
}

TEST(ConfidenceCodec, RefusesAnotherVersion) {
  std::string bytes = EncodeConfidence(SmallMap());
  bytes[4] = 2;
  EXPECT_EQ(DecodeConfidence(bytes).status().code(), ErrorCode::kIncompatible);
}

}  // namespace
}  // namespace depthfarm
