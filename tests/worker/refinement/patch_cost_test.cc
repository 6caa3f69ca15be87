#include "worker/refinement/patch_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/support/every_target.h"
#include "tests/worker/refinement/random_views.h"
#include "tests/worker/refinement/two_views.h"
#include "worker/refinement/colour_weight.h"

namespace depthfarm {
namespace {

using test::OnEveryTarget;
using test::Random;
using testing::ElementsAreArray;

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

std::vector<double> Costs(PatchCost& cost, const SlantedPlane& plane, const std::vector<PixelPosition>& pixels) {
  std::vector<double> costs(pixels.size());
  cost.Costs(plane, pixels, costs);
  return costs;
}

// Pixels here and there, and all of some stretches of rows.
std::vector<PixelPosition> SomePixels(Random& random, int width, int height) {
  std::vector<PixelPosition> pixels;
  int left = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (left == 0 && random.Chance(3)) left = random.Int(1, 9);
      if (left > 0) pixels.push_back({x, y});
      left = std::max(0, left - 1);
    }
  }
  return pixels;
}

TEST(PatchCost, IsThatOfItsDefinitionOnEveryTarget) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    // Wider and higher than what is summed at a time.
    const RandomViews first(random, random.Int(2, 150), random.Int(2, 70));
    const int width = first.own.width();
    const int height = first.own.height();
    const RandomViews second(random, width, height);
    const RandomViews third(random, width, height);
    const RandomViews fourth(random, width, height);
    std::vector<OtherView> others{first.Other(false), second.Other(false), third.Other(false), fourth.Other(false)};
    others.resize(seed % 5);
    const SlantedPlane plane{static_cast<float>(random.Int(-100, 100)) / 2000,
                             static_cast<float>(random.Int(-100, 100)) / 2000,
                             static_cast<float>(random.Int(-100, 100)) / 10};
    const std::vector<PixelPosition> pixels = SomePixels(random, width, height);
    std::vector<double> expected;
    expected.reserve(pixels.size());
    for (const auto& [x, y] : pixels) expected.push_back(CostPlainly(first.own, others, plane, x, y));
    OnEveryTarget([&] {
      PatchCost cost(first.own, others);
      EXPECT_THAT(Costs(cost, plane, pixels), ElementsAreArray(expected));
      EXPECT_THAT(Costs(cost, plane, pixels), ElementsAreArray(expected));  // nothing is left of the first time
    });
  }
}

TEST(PatchCost, IsOfEachPlaneByItself) {
  TwoViews near(kTrue);
  TwoViews far(kTrue + 1);  // shows something else
  const std::vector<OtherView> three{far.Other(), near.Other(), near.Other()};
  const std::vector<SlantedPlane> planes{{0, 0, 3}, {0.02F, -0.01F, 4}, {0, 0, 9}};
  std::vector<PixelPosition> all;
  for (int y = 0; y < TwoViews::kHeight; ++y)
    for (int x = 0; x < TwoViews::kWidth; ++x) all.push_back({x, y});
  PatchCost cost(near.own, three);
  for (const std::size_t index : {0U, 1U, 2U, 1U, 0U}) {
    const std::vector<double> costs = Costs(cost, planes[index], all);
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_EQ(costs[i], CostPlainly(near.own, three, planes[index], all[i].x, all[i].y)) << i << " plane " << index;
  }
}

TEST(PatchCost, IsLowOnTheTruePlane) {
  TwoViews views(kTrue);
  const std::vector<OtherView> others{views.Other()};
  PatchCost cost(views.own, others);
  const std::vector<PixelPosition> one{{20, 15}};
  EXPECT_LT(Costs(cost, {0, 0, float(kTrue)}, one)[0], 0.01);
  EXPECT_GT(Costs(cost, {0, 0, float(kTrue + 4)}, one)[0], 0.2);
  EXPECT_EQ(Costs(cost, {0, 0, 100}, one)[0], 0.5);  // seen by none
}

}  // namespace
}  // namespace depthfarm
