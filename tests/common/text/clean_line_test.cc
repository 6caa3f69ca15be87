#include "common/text/clean_line.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(CleanLine, KeepsTextAndCharactersOfOtherLanguages) {
  EXPECT_EQ(CleanLine("camera 'cäm€𝄞' is not there", 100), "camera 'cäm€𝄞' is not there");
  EXPECT_EQ(CleanLine("", 100), "");
}

TEST(CleanLine, ReplacesControlCharacters) { EXPECT_EQ(CleanLine("a\tb\x1b[31m\r\x7f", 100), "a b?[31m??"); }

TEST(CleanLine, ReplacesWhatIsNoUtf8) {
  EXPECT_EQ(CleanLine("a\xff\xfe", 100), "a??");
  EXPECT_EQ(CleanLine("\xc3", 100), "?") << "a character that ends early";
  EXPECT_EQ(CleanLine("\xc0\xaf", 100), "??") << "overlong";
  EXPECT_EQ(CleanLine("\xed\xa0\x80", 100), "???") << "a surrogate";
  EXPECT_EQ(CleanLine("\xf4\x90\x80\x80", 100), "????") << "past the last character";
}

TEST(CleanLine, CutsBetweenCharactersWithinTheBound) {
  EXPECT_EQ(CleanLine("0123456789", 10), "0123456789");
  EXPECT_EQ(CleanLine("0123456789a", 10), "0123456...");
  EXPECT_EQ(CleanLine("012345€€€", 10), "012345...");
  EXPECT_EQ(CleanLine("0123456789", 2), "..");
}

}  // namespace
}  // namespace depthfarm
