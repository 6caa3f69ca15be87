#include "worker/refinement/patch_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/worker/refinement/two_views.h"
#include "worker/refinement/colour_weight.h"

namespace depthfarm {
namespace {

constexpr double kTrue = 3;

// The cost by its definition.
double CostPlainly(const YcbcrImage& own, const std::vector<OtherView>& others, const SlantedPlane& plane, int x0,
                   int y0) {
  std::vector<double> means;
  for (const OtherView& other : others) {
    double sum = 0;
    double weights = 0;
    for (int y = y0 - 1; y <= y0 + 1; ++y) {
      for (int x = x0 - 1; x <= x0 + 1; ++x) {
        if (!own.Contains(x, y)) continue;
        const std::optional<double> rho = MisfitInFreeSpace(ColourOf(own(x, y)), other, x, y, plane.At(x, y));
        if (!rho) continue;
        sum += ColourWeight(own(x, y), own(x0, y0)) * *rho;
        weights += ColourWeight(own(x, y), own(x0, y0));
      }
    }
    if (weights > 0) means.push_back(sum / weights);
  }
  if (means.empty()) return 0.5;
  std::sort(means.begin(), means.end());
  if (means.size() < 3) return means[0];
  return (means[0] + means[1]) / 2;
}

TEST(PatchCost, IsThatOfItsDefinitionInAnyOrderOfPixelsAndPlanes) {
  TwoViews near(kTrue);
  TwoViews far(kTrue + 1);  // shows something else
  const std::vector<OtherView> two{near.Other(), far.Other()};
  const std::vector<OtherView> three{far.Other(), near.Other(), near.Other()};
  const std::vector<SlantedPlane> planes{{0, 0, 3}, {0.02F, -0.01F, 4}, {0, 0, 9}};
  for (const auto& others : {two, three}) {
    PatchCost cost(near.own, others);
    for (const PlaneIndex index : {0U, 1U, 2U, 1U, 0U}) {
      for (int y = 0; y < TwoViews::kHeight; y += index == 1 ? 3 : 1) {
        for (int x = 0; x < TwoViews::kWidth; ++x)
          ASSERT_EQ(cost.At(x, y, index, planes[index]), CostPlainly(near.own, others, planes[index], x, y))
              << x << "," << y << " plane " << index;
      }
    }
  }
}

TEST(PatchCost, IsLowOnTheTruePlane) {
  TwoViews views(kTrue);
  const std::vector<OtherView> others{views.Other()};
  PatchCost cost(views.own, others);
  EXPECT_LT(cost.At(20, 15, 0, {0, 0, float(kTrue)}), 0.01);
  EXPECT_GT(cost.At(20, 15, 1, {0, 0, float(kTrue + 4)}), 0.2);
  EXPECT_EQ(cost.At(20, 15, 2, {0, 0, 100}), 0.5);  // seen by none
}

}  // namespace
}  // namespace depthfarm
