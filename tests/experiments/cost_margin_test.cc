#include "tests/experiments/cost_margin.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace depthfarm {
namespace {

std::uint16_t MarginOf(std::initializer_list<int> costs) {
  PixelLabelling problem(1, 1, static_cast<int>(costs.size()));
  int level = 0;
  for (const int cost : costs) problem.CostsOf(level++)[0] = static_cast<std::uint16_t>(cost);
  return CostMargins(problem)(0, 0);
}

TEST(CostMargins, GrowWithTheDistanceOfTheTwoBestMinima) {
  EXPECT_EQ(MarginOf({900, 100, 900, 740, 900}), 65535 / 2);  // 640 apart
  EXPECT_LT(MarginOf({900, 100, 900, 300, 900}), MarginOf({900, 100, 900, 400, 900}));
  EXPECT_EQ(MarginOf({900, 100, 900, 400, 900, 700, 900}), MarginOf({400, 900, 100, 900}));
}

TEST(CostMargins, AreNothingForOneMinimumOrTwoAlike) {
  EXPECT_EQ(MarginOf({500, 400, 300, 400}), 0);
  EXPECT_EQ(MarginOf({200, 200, 200}), 0) << "a plateau is one minimum";
  EXPECT_EQ(MarginOf({100, 300, 100, 300}), 0);
}

}  // namespace
}  // namespace depthfarm
