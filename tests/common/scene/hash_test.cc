#include "common/scene/hash.h"

#include <gtest/gtest.h>

#include <cmath>

namespace depthfarm {
namespace {

TEST(SceneHash, UniformsFillTheUnitIntervalEvenly) {
  constexpr int kCount = 20000;
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = Uniform(7, i);
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kCount, 1.0 / 2, 0.01);  // five standard errors
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 0.011);
}

TEST(SceneHash, NormalsHaveMeanZeroDeviationOneAndNoCorrelation) {
  constexpr int kCount = 20000;
  double sum = 0;
  double squares = 0;
  double products = 0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const NormalPair pair = Normals(11, i);
    sum += pair.first + pair.second;
    squares += pair.first * pair.first + pair.second * pair.second;
    products += pair.first * pair.second;
    beyond_two += static_cast<int>(std::abs(pair.first) > 2);
  }
  EXPECT_NEAR(sum / (2 * kCount), 0, 0.025);
  EXPECT_NEAR(squares / (2 * kCount), 1, 0.04);
  EXPECT_NEAR(products / kCount, 0, 0.04);
  EXPECT_NEAR(beyond_two / static_cast<double>(kCount), 0.0455, 0.008);
}

TEST(SceneHash, KeysOfNamesDependOnEveryLetter) {
  EXPECT_NE(DerivedKey(1, "cam1"), DerivedKey(1, "cam11"));
  EXPECT_NE(DerivedKey(1, "cam12"), DerivedKey(1, "cam21"));
  EXPECT_NE(DerivedKey(1, "cam1"), DerivedKey(2, "cam1"));
}

}  // namespace
}  // namespace depthfarm
