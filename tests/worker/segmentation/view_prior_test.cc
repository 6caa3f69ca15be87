#include "worker/segmentation/view_prior.h"

#include <gtest/gtest.h>

#include "worker/segmentation/describe.h"

namespace depthfarm {
namespace {

constexpr int kWidth = 20;
constexpr int kHeight = 10;

// Two segments side by side.
SegmentMap Halves() {
  Grid<SegmentIndex> labels(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = kWidth / 2; x < kWidth; ++x) labels(x, y) = 1;
  return DescribeSegments(labels, YcbcrImage(kWidth, kHeight));
}

double PlaneAt(int x, int y) { return 0.1 + 0.002 * x + 0.001 * y; }

Grid<float> SlantedValues() {
  Grid<float> values(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) values(x, y) = static_cast<float>(PlaneAt(x, y));
  return values;
}

double At(const SegmentPrior& prior, int x, int y) {
  return static_cast<double>(prior.a) * x + static_cast<double>(prior.b) * y + prior.c;
}

TEST(MakePrior, KeepsValuesToHalfAStepAndWhatIsUnknown) {
  Grid<float> values = SlantedValues();
  values(3, 4) = 0;
  const ViewPrior prior = MakePrior(values, {});
  EXPECT_FALSE(prior.At(3, 4).has_value());
  for (int x = 0; x < kWidth; ++x) {
    const auto value = prior.At(x, 7);
    ASSERT_TRUE(value.has_value());
    EXPECT_NEAR(*value, values(x, 7), 0.51 * static_cast<double>(prior.step));
  }
}

TEST(MakePrior, AFewWildValuesDoNotTakeTheCodesOfAllOthers) {
  Grid<float> values(100, 100);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) values(x, y) = static_cast<float>(PlaneAt(x, y));
  values(3, 4) = 1e6F;
  values(7, 8) = 1e30F;
  const ViewPrior prior = MakePrior(values, {});
  EXPECT_FALSE(prior.At(3, 4).has_value());
  EXPECT_FALSE(prior.At(7, 8).has_value());
  EXPECT_NEAR(prior.At(50, 50).value(), values(50, 50), 1e-5);
}

TEST(MakePrior, OfOneValueOrNone) {
  EXPECT_EQ(MakePrior(Grid<float>(4, 4, 0.25F), {}).At(2, 2), 0.25);
  EXPECT_FALSE(MakePrior(Grid<float>(4, 4), {}).At(2, 2).has_value());
}

TEST(DescribePrior, FindsThePlaneOfASegment) {
  const std::vector<SegmentPrior> priors = DescribePrior(Halves(), MakePrior(SlantedValues(), {}));
  ASSERT_EQ(priors.size(), 2U);
  for (const SegmentPrior& prior : priors) {
    EXPECT_EQ(prior.weight, 1);
    EXPECT_NEAR(prior.a, 0.002, 2e-5);
    EXPECT_NEAR(prior.b, 0.001, 2e-5);
    EXPECT_NEAR(At(prior, 12, 3), PlaneAt(12, 3), 1e-4);
  }
}

TEST(DescribePrior, PixelsOfAnotherSurfaceDoNotCount) {
  Grid<float> values = SlantedValues();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 7; x < 10; ++x) values(x, y) = 0.5F;  // 3 of 10 columns of the first segment
  const std::vector<SegmentPrior> priors = DescribePrior(Halves(), MakePrior(values, {}));
  EXPECT_NEAR(At(priors[0], 3, 5), PlaneAt(3, 5), 1e-3);
  EXPECT_NEAR(At(priors[0], 0, 0), PlaneAt(0, 0), 1e-3);
}

TEST(DescribePrior, WeightIsTheShareOfCertainPixels) {
  Grid<float> values = SlantedValues();
  Grid<float> confidence(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < 5; ++x) values(x, y) = 0;
    for (int x = 10; x < 20; ++x) confidence(x, y) = 0.2F;
  }
  const std::vector<SegmentPrior> priors = DescribePrior(Halves(), MakePrior(values, confidence));
  EXPECT_FLOAT_EQ(priors[0].weight, 0.5F);
  EXPECT_FLOAT_EQ(priors[1].weight, 0.2F);
}

TEST(DescribePrior, SaysNothingWhereNothingIsKnown) {
  Grid<float> values = SlantedValues();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 10; ++x) values(x, y) = 0;
  const std::vector<SegmentPrior> priors = DescribePrior(Halves(), MakePrior(values, {}));
  EXPECT_EQ(priors[0], SegmentPrior());
  EXPECT_EQ(priors[1].weight, 1);
}

TEST(DescribePrior, OneKnownPixelIsALevelPlane) {
  Grid<float> values(kWidth, kHeight);
  values(2, 2) = 0.3F;
  const SegmentPrior prior = DescribePrior(Halves(), MakePrior(values, {}))[0];
  EXPECT_NEAR(prior.a, 0, 1e-9);
  EXPECT_NEAR(prior.b, 0, 1e-9);
  EXPECT_FLOAT_EQ(prior.c, 0.3F);
}

}  // namespace
}  // namespace depthfarm
