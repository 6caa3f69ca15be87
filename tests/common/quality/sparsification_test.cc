#include "common/quality/sparsification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace depthfarm {
namespace {

// 1000 pixels, a tenth of them off by 3 px; `confidence` of the i-th, the wrong ones first.
template <typename Function>
Sparsification OneTenthWrong(const Function& confidence) {
  Sparsification figures;
  for (int i = 0; i < 1000; ++i) figures.Add(static_cast<std::uint16_t>(confidence(i)), i < 100 ? 3 : 0);
  return figures;
}

TEST(Sparsification, OfAPerfectOrderIsTheBestCurve) {
  const Sparsification figures = OneTenthWrong([](int i) { return 60 * i; });
  EXPECT_NEAR(figures.WrongPercent(1), 10, 1e-9);
  EXPECT_NEAR(figures.WrongPercent(0.95), 100 * 50.0 / 950, 1e-9);
  EXPECT_NEAR(figures.WrongPercent(0.9), 0, 1e-9);
  EXPECT_NEAR(figures.MeanPx(1), 0.3, 1e-9);
  EXPECT_NEAR(figures.AuseWrongPercent(), 0, 1e-9);
  EXPECT_NEAR(figures.AusePx(), 0, 1e-9);
}

// With equal confidence every share of pixels is as wrong as all of them: the area is that of 10 % less the best curve,
// which is (10 - (100 - k)) / k for k > 90 % and 0 below.
TEST(Sparsification, OfEqualConfidenceIsTheMean) {
  const Sparsification figures = OneTenthWrong([](int) { return 30000; });
  for (const double kept : {0.01, 0.5, 1.0}) EXPECT_NEAR(figures.WrongPercent(kept), 10, 1e-9);
  double area = 0;
  for (int k = 1; k <= 100; ++k) area += 0.1 - (k > 90 ? (k - 90.0) / k : 0);
  EXPECT_NEAR(figures.AuseWrongPercent(), area, 1e-9);
  EXPECT_NEAR(figures.AusePx(), 3 * area / 100, 1e-9);
}

TEST(Sparsification, AWorseOrderHasALargerArea) {
  const double perfect = OneTenthWrong([](int i) { return 60 * i; }).AuseWrongPercent();
  const double some = OneTenthWrong([](int i) { return i % 10 == 0 ? 0 : 60 * i; }).AuseWrongPercent();
  const double opposite = OneTenthWrong([](int i) { return 60 * (999 - i); }).AuseWrongPercent();
  EXPECT_LT(perfect, some);
  EXPECT_LT(some, opposite);
}

TEST(Sparsification, ConfidenceThatSaysTheShareOfRightPixelsIsCalibrated) {
  EXPECT_NEAR(OneTenthWrong([](int) { return 58982; }).CalibrationErrorPercent(), 0, 1e-3);  // 0.9
  EXPECT_NEAR(OneTenthWrong([](int) { return 65535; }).CalibrationErrorPercent(), 10, 1e-9);
  EXPECT_NEAR(OneTenthWrong([](int i) { return i < 100 ? 0 : 65535; }).CalibrationErrorPercent(), 0, 1e-9);
}

TEST(Sparsification, PartsAddUp) {
  const auto code = [](int i) { return (i * 7919) % 65536; };
  Sparsification whole;
  Sparsification first;
  Sparsification second;
  for (int i = 0; i < 2000; ++i) {
    const double px = (i * 31 % 100) / 40.0;
    whole.Add(static_cast<std::uint16_t>(code(i)), px);
    (i % 3 == 0 ? first : second).Add(static_cast<std::uint16_t>(code(i)), px);
  }
  first.Add(second);
  EXPECT_EQ(first.pixels(), 2000);
  EXPECT_NEAR(first.AuseWrongPercent(), whole.AuseWrongPercent(), 1e-9);
  EXPECT_NEAR(first.AusePx(), whole.AusePx(), 1e-9);
  EXPECT_NEAR(first.CalibrationErrorPercent(), whole.CalibrationErrorPercent(), 1e-9);
}

TEST(Sparsification, HugeErrorsAreBoundedAndNoPixelsGiveNoFigure) {
  Sparsification figures;
  EXPECT_TRUE(std::isnan(figures.WrongPercent(1)));
  EXPECT_TRUE(std::isnan(figures.AusePx()));
  figures.Add(5, 1e9);
  EXPECT_EQ(figures.MeanPx(1), Sparsification::kMostPx);
}

}  // namespace
}  // namespace depthfarm
