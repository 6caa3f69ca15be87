#include "coordinator/service/refusals.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using std::chrono::seconds;

TEST(RefusalPace, AFloodMakesOneLineAMinute) {
  RefusalPace pace;
  const std::chrono::steady_clock::time_point start{};
  int lines = 0;
  std::uint64_t total = 0;
  for (int second = 0; second < 600; ++second) {
    total += 1000;
    if (pace.Due(total, start + seconds(second))) ++lines;
  }
  EXPECT_EQ(lines, 10);
}

TEST(RefusalPace, TheFirstIsToldAtOnceAndNothingNewNever) {
  RefusalPace pace;
  const std::chrono::steady_clock::time_point start{};
  EXPECT_FALSE(pace.Due(0, start));
  EXPECT_TRUE(pace.Due(1, start + seconds(5)));
  EXPECT_FALSE(pace.Owes(1));
  EXPECT_TRUE(pace.Owes(2));
  EXPECT_FALSE(pace.Due(1, start + seconds(500)));
  EXPECT_TRUE(pace.Due(2, start + seconds(501)));
}

}  // namespace
}  // namespace depthfarm
