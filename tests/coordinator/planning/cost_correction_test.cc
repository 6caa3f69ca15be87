#include "coordinator/planning/cost_correction.h"

#include <gtest/gtest.h>

#include <limits>

namespace depthfarm {
namespace {

constexpr TaskKind kKind = TaskKind::kRefine;

TEST(CostCorrection, KnowsNothingAtFirst) {
  const CostCorrection correction;
  EXPECT_DOUBLE_EQ(correction.Factor(kKind, true), 1);
  const TaskCost cost{2.5, 7, 9};
  EXPECT_EQ(correction.Corrected(kKind, true, cost), cost);
}

TEST(CostCorrection, ThePredictionCountsAsOneMeasurement) {
  CostCorrection correction;
  correction.Learn(kKind, true, 1, 4);
  EXPECT_NEAR(correction.Factor(kKind, true), 2, 1e-12);  // the geometric mean of 1 and 4
  for (int i = 0; i < 30; ++i) correction.Learn(kKind, true, 0.5, 2);
  EXPECT_NEAR(correction.Factor(kKind, true), 4, 0.25);
}

TEST(CostCorrection, TooLongAndTooShortByTheSameFactorCancel) {
  CostCorrection correction;
  for (int i = 0; i < 20; ++i) {
    correction.Learn(kKind, false, 1, 3);
    correction.Learn(kKind, false, 3, 1);
  }
  EXPECT_NEAR(correction.Factor(kKind, false), 1, 0.05);
}

TEST(CostCorrection, LearnsEachKindAndFrameTypeByItself) {
  CostCorrection correction;
  correction.Learn(kKind, true, 1, 4);
  EXPECT_DOUBLE_EQ(correction.Factor(kKind, false), 1);
  EXPECT_DOUBLE_EQ(correction.Factor(TaskKind::kEstimate, true), 1);
  const TaskCost corrected = correction.Corrected(kKind, true, {3, 7, 9});
  EXPECT_NEAR(corrected.seconds, 6, 1e-12);
  EXPECT_EQ(corrected.peak_memory_bytes, 7U);
  EXPECT_EQ(corrected.result_bytes, 9U);
}

TEST(CostCorrection, StaysWithinBoundsAndFollowsWhatChanges) {
  CostCorrection correction;
  for (int i = 0; i < 1000; ++i) correction.Learn(kKind, true, 1, 1e6);
  EXPECT_LE(correction.Factor(kKind, true), CostCorrection::kMostFactor * (1 + 1e-9));
  EXPECT_GT(correction.Factor(kKind, true), CostCorrection::kMostFactor * 0.9);
  for (int i = 0; i < 1000; ++i) correction.Learn(kKind, true, 1, 1e-6);
  EXPECT_GE(correction.Factor(kKind, true), (1 - 1e-9) / CostCorrection::kMostFactor);
  EXPECT_LT(correction.Factor(kKind, true), 1.1 / CostCorrection::kMostFactor);
}

TEST(CostCorrection, IgnoresWhatIsNoDuration) {
  CostCorrection correction;
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double seconds : {0.0, -1.0, kNotANumber, kInfinity}) {
    correction.Learn(kKind, true, 1, seconds);
    correction.Learn(kKind, true, seconds, 1);
  }
  EXPECT_DOUBLE_EQ(correction.Factor(kKind, true), 1);
}

}  // namespace
}  // namespace depthfarm
