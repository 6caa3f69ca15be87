#include "common/wire/bounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::HasSubstr;

TEST(CheckTags, TakesNamesOfPlainCharacters) {
  const Result<std::set<std::string>> tags = CheckTags("tags", {"room-2", "AVX512_x", "os:debian.12"});
  ASSERT_TRUE(tags.ok()) << tags.status().message();
  EXPECT_EQ(tags->size(), 3U);
  EXPECT_TRUE(CheckTags("tags", {})->empty());
}

TEST(CheckTags, NamesWhatIsWrong) {
  EXPECT_THAT(CheckTags("tags", {"a b"}).status().message(), HasSubstr("'a b'"));
  EXPECT_THAT(CheckTags("tags", {"a", ""}).status().message(), HasSubstr("expected letters"));
  EXPECT_THAT(CheckTags("tags", {"a", "a"}).status().message(), HasSubstr("twice"));
  EXPECT_THAT(CheckTags("tags", {"b\xc3\xa4r"}).status().message(), HasSubstr("expected letters"));
  EXPECT_FALSE(CheckTags("tags", {std::string(kMaxTagBytes + 1, 'x')}).ok());
  std::vector<std::string> many;
  for (int i = 0; i <= kMaxTags; ++i) many.push_back(std::to_string(i));
  EXPECT_FALSE(CheckTags("tags", many).ok());
}

}  // namespace
}  // namespace depthfarm
