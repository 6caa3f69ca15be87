#include "common/files/file_bundle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/little_endian.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string RefusalOf(std::string_view bundle) {
  const auto files = DecodeFileBundle(bundle);
  EXPECT_EQ(files.status().code(), ErrorCode::kCorrupt);
  return files.status().message();
}

TEST(FileBundle, GivesBackTheFilesInTheirOrder) {
  const std::string bytes(1000, '\0');
  const std::string bundle =
      EncodeFileBundle({{"depth/cam1/0000.png", "one"}, {"depth/cam0/0000.png", bytes}, {"empty", ""}});
  const auto files = DecodeFileBundle(bundle);
  ASSERT_TRUE(files.ok()) << files.status().message();
  ASSERT_THAT(*files, SizeIs(3));
  EXPECT_EQ((*files)[0].path, "depth/cam1/0000.png");
  EXPECT_EQ((*files)[0].bytes, "one");
  EXPECT_EQ((*files)[1].bytes, bytes);
  EXPECT_THAT((*files)[2].bytes, IsEmpty());
}

TEST(FileBundle, MayBeEmpty) { EXPECT_THAT(DecodeFileBundle(EncodeFileBundle({})).value(), IsEmpty()); }

TEST(FileBundle, RefusesPathsThatLeaveTheFolder) {
  for (const std::string path : {"/etc/passwd", "../a", "a/../../b", "a//b", "a/", "./a", "..", "a\nb", "a/\x7f"})
    EXPECT_THAT(RefusalOf(EncodeFileBundle({{path, "x"}})), HasSubstr("path 0 is not made of plain names")) << path;
  EXPECT_THAT(RefusalOf(EncodeFileBundle({{"", "x"}})), HasSubstr("path 0 has 0 bytes"));
  EXPECT_THAT(RefusalOf(EncodeFileBundle({{std::string(1001, 'a'), "x"}})), HasSubstr("path 0 has 1001 bytes"));
  EXPECT_THAT(RefusalOf(EncodeFileBundle({{"a", "x"}, {"a", "y"}})), HasSubstr("'a' is there twice"));
}

TEST(FileBundle, RefusesEveryTruncationAndWhatFollows) {
  const std::string bundle = EncodeFileBundle({{"a/b", "12345"}, {"c", "678"}});
  for (std::size_t size = 0; size < bundle.size(); ++size)
    EXPECT_FALSE(DecodeFileBundle(std::string_view(bundle).substr(0, size)).ok()) << size;
  EXPECT_THAT(RefusalOf(bundle + "x"), HasSubstr("1 bytes follow"));
}

TEST(FileBundle, RefusesOtherFormatsAndCountsOutOfBounds) {
  EXPECT_THAT(RefusalOf("PNG and so on, twelve bytes"), HasSubstr("does not begin with DFFB"));
  std::string other = EncodeFileBundle({});
  other[4] = 2;
  EXPECT_THAT(RefusalOf(other), HasSubstr("version is 2, expected 1"));
  std::string many = "DFFB";
  AppendU32(1, many);
  AppendU32(0xFFFFFFFF, many);
  EXPECT_THAT(RefusalOf(many), HasSubstr("has 4294967295 files, expected at most 2048"));
  std::string large = "DFFB";
  AppendU32(1, large);
  AppendU32(1, large);
  AppendU32(1, large);
  AppendU64(~std::uint64_t{0}, large);
  large += "a";
  EXPECT_THAT(RefusalOf(large), HasSubstr("ends in 'a'"));
}

}  // namespace
}  // namespace depthfarm
