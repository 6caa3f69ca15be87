#include "common/image/depth_code.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace depthfarm {
namespace {

DepthCode CodeOf(double z_near, double z_far) { return *DepthCode::Create(z_near, z_far); }

TEST(DepthCode, EndsOfTheRangeAreTheFirstAndLastCode) {
  const DepthCode code = CodeOf(42, 130);
  EXPECT_EQ(code.FromInverseDepth(1.0 / 130), 1);
  EXPECT_EQ(code.FromInverseDepth(1.0 / 42), 65535);
}

TEST(DepthCode, MiddleOfTheInverseRangeIsTheMiddleCode) {
  // 1/2 and 1/4 are exact: their mean 3/8 is half-way, 1 + 65534 / 2.
  EXPECT_EQ(CodeOf(2, 4).FromInverseDepth(0.375), 32768);
  EXPECT_DOUBLE_EQ(CodeOf(2, 4).ToInverseDepth(32768), 0.375);
}

TEST(DepthCode, NoDepthIsZeroBothWays) {
  const DepthCode code = CodeOf(1, 10);
  for (const double none :
       {0.0, -0.5, std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(code.FromInverseDepth(none), 0) << none;
  }
  EXPECT_EQ(code.ToInverseDepth(0), 0);
}

TEST(DepthCode, DepthBeyondTheRangeGetsItsNearerEnd) {
  const DepthCode code = CodeOf(1, 10);
  EXPECT_EQ(code.FromInverseDepth(1 / 0.5), 65535);
  EXPECT_EQ(code.FromInverseDepth(1 / 1e6), 1);
}

TEST(DepthCode, EveryCodeSurvivesTheWayOverFloatDepth) {
  Grid<std::uint16_t> codes(256, 256);
  for (std::size_t i = 0; i < codes.size(); ++i) codes.values()[i] = static_cast<std::uint16_t>(i);
  for (const DepthCode& code : {CodeOf(42, 130), CodeOf(0.48, 0.66), CodeOf(34.5, 2760.5), CodeOf(1e-3, 1e4)}) {
    EXPECT_EQ(EncodeDepth(DecodeDepth(codes, code), code), codes) << code.z_near();
  }
}

TEST(DepthCode, ErrorOfInverseDepthIsAtMostHalfAStep) {
  std::mt19937_64 random(7);
  for (int range = 0; range < 20; ++range) {
    const double z_near = std::uniform_real_distribution(0.01, 100.0)(random);
    const double z_far = z_near * std::uniform_real_distribution(1.1, 50.0)(random);
    const DepthCode code = CodeOf(z_near, z_far);
    const double half_step = (1 / z_near - 1 / z_far) / 65534 / 2;
    std::uniform_real_distribution inverse(1 / z_far, 1 / z_near);
    for (int i = 0; i < 1000; ++i) {
      const double value = inverse(random);
      EXPECT_LE(std::abs(code.ToInverseDepth(code.FromInverseDepth(value)) - value), half_step * (1 + 1e-9));
    }
  }
}

TEST(DepthCode, NearerIsNeverASmallerCode) {
  const DepthCode code = CodeOf(3, 7);
  std::uint16_t last = 0;
  for (double z = 7.5; z > 2.5; z -= 0.001) {
    const std::uint16_t now = code.FromInverseDepth(1 / z);
    EXPECT_GE(now, last);
    last = now;
  }
}

TEST(DepthCode, InverseDepthAndDepthGiveTheSameCodes) {
  const DepthCode code = CodeOf(2, 8);
  DepthMap depth(4, 1);
  depth.values() = {2, 4, 8, 0};
  Grid<float> inverse(4, 1);
  inverse.values() = {0.5F, 0.25F, 0.125F, 0};
  EXPECT_EQ(EncodeDepth(depth, code), EncodeInverseDepth(inverse, code));
}

TEST(DepthCode, RefusesRangesThatAreNone) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& [z_near, z_far] : {std::pair{0.0, 1.0},
                                      {-1.0, 1.0},
                                      {2.0, 1.0},
                                      {1.0, 1.0},
                                      {1.0, infinity},
                                      {std::nan(""), 1.0},
                                      {1.0, std::nan("")},
                                      {1e-320, 1.0}}) {
    const auto code = DepthCode::Create(z_near, z_far);
    EXPECT_EQ(code.status().code(), ErrorCode::kInvalidArgument) << z_near << " " << z_far;
    EXPECT_THAT(code.status().message(), ::testing::HasSubstr("0 < zNear < zFar"));
  }
}

}  // namespace
}  // namespace depthfarm
