#include "common/quality/bjontegaard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace depthfarm {
namespace {

std::vector<RatePoint> Scaled(std::vector<RatePoint> curve, double bits, double db) {
  for (RatePoint& point : curve) {
    point.bits *= bits;
    point.psnr += db;
  }
  return curve;
}

const std::vector<RatePoint> kCurve = {{686760, 40.28}, {309580, 37.18}, {157110, 34.24}, {85950, 31.42}};

double Percent(const std::vector<RatePoint>& anchor, const std::vector<RatePoint>& tested) {
  const Result<double> result = BjontegaardRatePercent(anchor, tested);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.ok() ? *result : std::numeric_limits<double>::quiet_NaN();
}

TEST(Bjontegaard, EqualCurvesDifferByNothing) { EXPECT_NEAR(Percent(kCurve, kCurve), 0, 1e-9); }

// The same quality for 0.8 of the bits everywhere is 20 % less, whatever the curve's shape.
TEST(Bjontegaard, AConstantShareOfTheBitsIsThatShare) {
  EXPECT_NEAR(Percent(kCurve, Scaled(kCurve, 0.8, 0)), -20, 1e-9);
  EXPECT_NEAR(Percent(kCurve, Scaled(kCurve, 1.5, 0)), 50, 1e-9);
}

// log10(bits) = psnr / 10: 1 dB more at the same bits is 10^-0.1 of the bits at the same PSNR.
TEST(Bjontegaard, AnExponentialCurveShiftedByOneDecibel) {
  std::vector<RatePoint> curve;
  for (const double psnr : {30.0, 33.0, 36.0, 40.0}) curve.push_back({std::pow(10.0, psnr / 10), psnr});
  EXPECT_NEAR(Percent(curve, Scaled(curve, 1, 1)), 100 * (std::pow(10.0, -0.1) - 1), 1e-9);
}

// Two curves that bend differently, integrated in closed form: log10(bits) = 4 + x^3 and 4 + x^2, x = (psnr - 35) / 5,
// known at x = -1 .. 1; means over x of x^2 - x^3 is 1/3.
TEST(Bjontegaard, CurvesThatCrossAreIntegrated) {
  std::vector<RatePoint> cubic;
  std::vector<RatePoint> square;
  for (const double x : {-1.0, -0.5, 0.25, 1.0}) {
    cubic.push_back({std::pow(10.0, 4 + x * x * x), 35 + 5 * x});
    square.push_back({std::pow(10.0, 4 + x * x), 35 + 5 * x});
  }
  EXPECT_NEAR(Percent(cubic, square), 100 * (std::pow(10.0, 1.0 / 3) - 1), 1e-7);
}

TEST(Bjontegaard, OrderOfPointsDoesNotMatter) {
  const std::vector<RatePoint> reversed(kCurve.rbegin(), kCurve.rend());
  EXPECT_NEAR(Percent(kCurve, Scaled(reversed, 0.9, 0)), -10, 1e-9);
}

TEST(Bjontegaard, RefusesWhatHasNoAnswer) {
  const auto message = [](const std::vector<RatePoint>& a, const std::vector<RatePoint>& b) {
    const Result<double> result = BjontegaardRatePercent(a, b);
    return result.ok() ? std::string("accepted") : result.status().message();
  };
  EXPECT_THAT(message({kCurve[0], kCurve[1], kCurve[2]}, kCurve), testing::HasSubstr("3 points"));
  EXPECT_THAT(message(kCurve, Scaled(kCurve, 1, 20)), testing::HasSubstr("nothing in common"));
  EXPECT_THAT(message(kCurve, Scaled(kCurve, 0, 0)), testing::HasSubstr("0.000000 bits"));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message(kCurve, Scaled(kCurve, 1, infinity)), testing::HasSubstr("inf dB"));
  EXPECT_THAT(message({kCurve[0], kCurve[0], kCurve[1], kCurve[2]}, kCurve), testing::HasSubstr("two points"));
}

}  // namespace
}  // namespace depthfarm
