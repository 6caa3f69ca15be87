#include "coordinator/fetching/result_fetch.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(FormatRanges, JoinsNeighbours) {
  EXPECT_EQ(FormatRanges({}), "");
  EXPECT_EQ(FormatRanges({4}), "4");
  EXPECT_EQ(FormatRanges({4, 5}), "4, 5");
  EXPECT_EQ(FormatRanges({1, 4, 5, 6, 9, 10}), "1, 4 to 6, 9, 10");
}

TEST(FormatRanges, EndsLongLists) {
  std::vector<int> odd;
  for (int i = 1; i < 100; i += 2) odd.push_back(i);
  EXPECT_TRUE(FormatRanges(odd).ends_with(", 37, 39 and 30 more")) << FormatRanges(odd);
}

}  // namespace
}  // namespace depthfarm
