#include "common/media/pfm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;

TEST(Pfm, ComesBackToTheLastBit) {
  Grid<float> values(3, 2);
  values.values() = {0, -1.5F, 1e-30F, std::numeric_limits<float>::infinity(), 3.1415927F, 65504};
  const auto read = DecodePfm(EncodePfm(values));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(*read, values);
}

TEST(Pfm, BottomRowComesFirstInBothByteOrders) {
  // 1 x 2: below 1.0 = 0x3f800000, above 2.0 = 0x40000000.
  const std::string big("Pf\n1 2\n1.0\n\x3f\x80\0\0\x40\0\0\0", 19);
  const std::string little("Pf\n1 2\n-1.0\n\0\0\x80\x3f\0\0\0\x40", 20);
  for (const std::string& bytes : {big, little}) {
    const auto read = DecodePfm(bytes);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ((*read)(0, 0), 2.0F);
    EXPECT_EQ((*read)(0, 1), 1.0F);
  }
}

TEST(Pfm, SampleBytesThatLookLikeSpaceAreSamples) {
  Grid<float> values(1, 1);
  values.values() = {std::bit_cast<float>(std::uint32_t{0x0a0a200a})};
  EXPECT_EQ(*DecodePfm(EncodePfm(values)), values);
}

TEST(Pfm, BadFilesAreErrors) {
  for (const auto& [bytes, words] : {
           std::pair<std::string, std::string>{"", "not a PFM"},
           {"P5\n1 1\n255\nx", "not a PFM"},
           {"PF\n1 1\n-1.0\n" + std::string(12, 'x'), "colour"},
           {"Pf\n0 1\n-1.0\n", "bad PFM header"},
           {"Pf\n1 40000\n-1.0\n", "1 to 32768"},
           {"Pf\n99999999999 1\n-1.0\n", "bad PFM header"},
           {"Pf\n1 1\n0\nxxxx", "scale"},
           {"Pf\n1 1\nnan\nxxxx", "scale"},
           {"Pf\n1 x\n-1\nxxxx", "bad PFM header"},
           {"Pf\n2 1\n-1.0\nxxxxxxx", "7 bytes of samples, expected 8"},
           {"Pf\n1 1\n-1.0\nxxxxx", "5 bytes of samples, expected 4"},
       }) {
    const auto read = DecodePfm(bytes);
    EXPECT_EQ(read.status().code(), ErrorCode::kInvalidArgument) << bytes;
    EXPECT_THAT(read.status().message(), HasSubstr(words));
  }
}

TEST(Pfm, MessagesOfFilesBeginWithThePath) {
  const testing_support::TemporaryFolder folder;
  const std::string path = folder.Write("x.pfm", "nothing");
  EXPECT_THAT(ReadPfm(path).status().message(), HasSubstr(path + ": is not a PFM"));
}

}  // namespace
}  // namespace depthfarm
