#include "common/calibration/robust_range.h"

#include <gtest/gtest.h>

#include <limits>

namespace depthfarm {
namespace {

TEST(RobustRange, HasAMarginAroundThePercentiles) {
  std::vector<float> depths;
  for (int i = 1000; i > 0; --i) depths.push_back(static_cast<float>(i));
  const auto range = RobustRange(depths);
  ASSERT_TRUE(range.ok()) << range.status().message();
  EXPECT_NEAR(range->z_near, 10 / 1.1, 1);
  EXPECT_NEAR(range->z_far, 990 / 0.8, 2);
}

TEST(RobustRange, AFewWrongPointsChangeLittle) {
  std::vector<float> depths(1000, 5.0F);
  for (int i = 0; i < 9; ++i) depths.push_back(0.001F);
  for (int i = 0; i < 9; ++i) depths.push_back(1e6F);
  for (int i = 0; i < 900; ++i) depths.push_back(-3);  // behind
  depths.push_back(std::numeric_limits<float>::quiet_NaN());
  const auto range = RobustRange(depths);
  ASSERT_TRUE(range.ok()) << range.status().message();
  EXPECT_NEAR(range->z_near, 5 / 1.1, 1e-6);
  EXPECT_NEAR(range->z_far, 5 / 0.8, 1e-6);
}

TEST(RobustRange, TooFewPointsTellNone) {
  std::vector<float> depths(19, 5.0F);
  depths.resize(500, -1.0F);
  EXPECT_EQ(RobustRange(depths).status().code(), ErrorCode::kInvalidArgument);
  depths.push_back(6);
  EXPECT_TRUE(RobustRange(depths).ok());
}

}  // namespace
}  // namespace depthfarm
