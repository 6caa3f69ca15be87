#include "common/base/strong_id.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <type_traits>
#include <unordered_set>

namespace depthfarm {
namespace {

using Apple = StrongId<struct AppleTag, std::uint64_t>;
using Pear = StrongId<struct PearTag, std::uint64_t>;

TEST(StrongId, KindsAndNumbersDoNotMix) {
  EXPECT_FALSE((std::is_convertible_v<std::uint64_t, Apple>));
  EXPECT_FALSE((std::is_convertible_v<Apple, std::uint64_t>));
  EXPECT_FALSE((std::is_constructible_v<Apple, Pear>));
  EXPECT_FALSE((std::is_assignable_v<Apple&, Pear>));
  EXPECT_TRUE((std::is_constructible_v<Apple, std::uint64_t>));
}

TEST(StrongId, IsZeroUnlessToldAndKeepsItsValue) {
  EXPECT_EQ(Apple().value(), 0u);
  EXPECT_EQ(Apple(7).value(), 7u);
}

TEST(StrongId, ComparesAsItsValueDoes) {
  EXPECT_EQ(Apple(3), Apple(3));
  EXPECT_NE(Apple(3), Apple(4));
  EXPECT_LT(Apple(3), Apple(4));
  const std::map<Apple, int> ordered = {{Apple(9), 2}, {Apple(1), 1}};
  EXPECT_EQ(ordered.begin()->first, Apple(1));
}

TEST(StrongId, IsAKeyOfHashTables) {
  const std::unordered_set<Apple> apples = {Apple(1), Apple(2), Apple(1)};
  EXPECT_EQ(apples.size(), 2u);
  EXPECT_TRUE(apples.contains(Apple(2)));
}

}  // namespace
}  // namespace depthfarm
